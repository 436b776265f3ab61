"""Labels maps one after the other in a thread of its own."""

from __future__ import annotations

import tempfile
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import placegraph as pg
import yaml
from numpy.typing import NDArray
from PIL import Image

from .grids import GridData, label_cells, mask_cells, region_cells
from .settings import Settings

Image.MAX_IMAGE_PIXELS = None  # masks are as large as the map that was labeled

NO_GRAPH = '{"type": "FeatureCollection", "features": []}'
"""What stands for a route graph that has no edges."""


@dataclass(frozen=True)
class Mask:
    """A mask of Nav2's costmap filters: its values, and the content of ``nav2_msgs/CostmapFilterInfo``."""

    grid: GridData
    kind: int
    base: float
    multiplier: float


@dataclass(frozen=True)
class Output:
    """All that is published of one map."""

    grid: GridData
    result: pg.Result
    labels: GridData | None
    regions: GridData | None
    region_image: NDArray[np.uint32] | None
    route_graph: str | None
    masks: dict[str, Mask]
    remarks: tuple[str, ...]
    """What could not be made, and why."""
    warnings: tuple[str, ...]
    """What the check of the map found, and edits that do not apply."""
    elapsed_s: float


class Labeler:
    """Takes maps and hands out results: the newest map is labeled next, those between are left out.

    Parameters
    ----------
    settings : Settings
        What to label with.
    on_output, on_error : callable
        Called in the labeler's thread with an :class:`Output`, or with what was wrong with a map.
    """

    def __init__(
        self, settings: Settings, on_output: Callable[[Output], None], on_error: Callable[[str], None]
    ) -> None:
        self._on_output, self._on_error = on_output, on_error
        self._changed = threading.Condition()
        self._settings = settings
        self._waiting: GridData | None = None
        self._labeled: GridData | None = None
        self._frozen: GridData | None = None
        self._is_closed = False
        self._session = pg.Session(load_model(settings))
        self._last: pg.Topology | None = pg.Topology.load(settings.previous) if settings.previous else None
        self._last_frame: str | None = None
        self._thread = threading.Thread(target=self._run, name="labeler", daemon=True)
        self._thread.start()

    def submit(self, grid: GridData) -> bool:
        """Has a map labeled; returns whether it will be: a frozen labeler takes the first map only."""
        with self._changed:
            if self._settings.follow == "frozen" and self._frozen is not None:
                return False
            if self._frozen is None:
                self._frozen = grid
            if self._waiting is None and grid.is_same_map(self._labeled):
                return False
            self._waiting = grid
            self._changed.notify()
            return True

    def change(self, settings: Settings) -> None:
        """Labels with other settings from now on, and the last map again where its result may differ.

        Raises :class:`placegraph.Error` if the model cannot be read; then nothing changes.
        """
        changed = settings.changed(self._settings)
        session = pg.Session(load_model(settings)) if "model" in changed else self._session
        with self._changed:
            self._settings, self._session = settings, session
            if "follow" in changed and settings.follow == "frozen":
                # The map of now is the one that stays.
                self._frozen = self._waiting or self._labeled
            if changed & Settings.RELABEL and self._waiting is None:
                self._waiting = self._labeled
            self._changed.notify()

    def close(self, timeout_s: float = 5.0) -> None:
        """Ends the thread after the map that is being labeled, or leaves it behind after ``timeout_s``."""
        with self._changed:
            self._is_closed = True
            self._changed.notify()
        self._thread.join(timeout_s)

    def _run(self) -> None:
        started_s = -float("inf")
        while True:
            with self._changed:
                while not self._is_closed:
                    rest_s = started_s + self._settings.min_interval_s - time.monotonic()
                    if self._waiting is not None and rest_s <= 0:
                        break
                    self._changed.wait(rest_s if self._waiting is not None else None)
                if self._is_closed:
                    return
                grid, settings, session = self._waiting, self._settings, self._session
                self._waiting = None
            assert grid is not None
            started_s = time.monotonic()
            self._label(grid, settings, session)

    def _label(self, grid: GridData, settings: Settings, session: pg.Session) -> None:
        # Numbers of places in another frame mean nothing here.
        if self._last_frame not in (None, grid.frame_id):
            self._last = None
            with self._changed:
                self._session = session = pg.Session(load_model(settings))
        try:
            output = label(grid, settings, session, self._last)
            self._last, self._last_frame = output.result.topology, grid.frame_id
            with self._changed:
                self._labeled = grid
            self._on_output(output)
        except Exception as error:  # whatever a map does to us, the next one may be good
            text = str(error) if isinstance(error, pg.Error) else f"{type(error).__name__}: {error}"
            with self._changed:
                if self._frozen is grid:
                    self._frozen = None
            self._on_error(text)


def load_model(settings: Settings) -> pg.Model:
    """The model that the settings name."""
    return pg.load_model(settings.model) if settings.model else pg.default_model()


def label(grid: GridData, settings: Settings, session: pg.Session, previous: pg.Topology | None) -> Output:
    """Labels one map and makes all that is published of it."""
    started_s = time.monotonic()
    map = grid.to_map(
        name=settings.map_name, occupied_thresh=settings.occupied_thresh, free_thresh=settings.free_thresh
    )
    found = map.findings()
    errors = [finding.text for finding in found if finding.severity == "error"]
    if errors:
        raise pg.MapError("; ".join(errors))
    result = session.update(
        map,
        previous=previous,
        edits=settings.edits or None,
        robot_radius=settings.robot_radius_m,
        threads=settings.threads or None,
    )
    remarks: list[str] = []

    def exported(format: str, folder: str) -> bool:
        try:
            result.export(format, folder, masks=settings.masks or None)
        except pg.ExportError as error:
            remarks.append(str(error))
            return False
        return True

    graph, masks = None, {}
    with tempfile.TemporaryDirectory(prefix="placegraph-") as folder:
        if "route_graph" in settings.topics:
            graph = Path(folder, "route_graph.geojson").read_text() if exported("nav2", folder) else NO_GRAPH
        for kind in ("keepout", "speed"):
            if f"{kind}_mask" in settings.topics and exported(f"nav2-{kind}", folder):
                masks[kind] = _read_mask(Path(folder), kind, grid.frame_id)
    return Output(
        grid=grid,
        result=result,
        labels=grid.with_cells(label_cells(result.labels)) if "labels" in settings.topics else None,
        regions=grid.with_cells(region_cells(result.regions)) if "regions" in settings.topics else None,
        region_image=result.regions if "region_image" in settings.topics else None,
        route_graph=graph,
        masks=masks,
        remarks=tuple(remarks),
        warnings=(
            *(finding.text for finding in found if finding.severity == "warning"),
            *result.topology.document.get("errors", ()),
        ),
        elapsed_s=time.monotonic() - started_s,
    )


def _read_mask(folder: Path, kind: str, frame_id: str) -> Mask:
    """The mask in the files of the format ``nav2-KIND``."""
    with Image.open(folder / f"{kind}.png") as image:
        pixels = np.asarray(image)
    about: dict[str, Any] = yaml.safe_load((folder / f"{kind}.yaml").read_text())
    nodes: dict[str, Any] = yaml.safe_load((folder / f"{kind}_params.yaml").read_text())
    info = next(
        node["ros__parameters"] for node in nodes.values() if "multiplier" in node.get("ros__parameters", {})
    )
    x, y, yaw = about["origin"]
    cells = np.ascontiguousarray(mask_cells(pixels)[::-1])
    grid = GridData(frame_id, float(about["resolution"]), (float(x), float(y), float(yaw)), cells)
    return Mask(grid, int(info["type"]), float(info["base"]), float(info["multiplier"]))
