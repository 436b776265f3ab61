"""Labeling a map, and what comes of it."""

from __future__ import annotations

import base64
import html
import json
import os
from collections.abc import Iterable
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._grid import OccupancyGrid, Path, as_map
from ._model import ClassInfo, Model, as_model
from ._topology import Connection, Doorway, Place, Topology, as_topology, summary

if TYPE_CHECKING:
    from matplotlib.axes import Axes

T = TypeVar("T", bound=np.generic)


class Result:
    """A labeled map. From :func:`label`.

    Arrays have the shape (H, W) of the map, row 0 at the top. They are made when they are first asked for, and
    are read-only: copy them to change them. Everything in meters is in the map frame.
    """

    def __init__(self) -> None:
        raise TypeError("results come from placegraph.label")

    @classmethod
    def _of(cls, native: _native.Labeled, map: OccupancyGrid, model: Model) -> Result:
        self = cls.__new__(cls)
        self._handle, self._map, self._model = native, map, model
        return self

    _handle: _native.Labeled
    _map: OccupancyGrid
    _model: Model

    @property
    def map(self) -> OccupancyGrid:
        """The map that was labeled."""
        return self._map

    @property
    def model(self) -> Model:
        """The model it was labeled with."""
        return self._model

    @property
    def classes(self) -> tuple[ClassInfo, ...]:
        """The classes; label k is ``classes[k - 1]``."""
        return self._model.classes

    @cached_property
    def labels(self) -> NDArray[np.uint8]:
        """(H, W) uint8: k for the k-th class, counted from 1; 0 where there is no free cell."""
        return _read_only(self._handle.labels())

    @cached_property
    def regions(self) -> NDArray[np.uint32]:
        """(H, W) uint32: the number of its place for every cell of one; 0 elsewhere."""
        return _read_only(self._handle.regions())

    @cached_property
    def probabilities(self) -> NDArray[np.float32]:
        """(K, H, W) float32: probability of every class after smoothing, before doorways are marked; 0 where there is no free cell."""
        return _read_only(self._handle.probabilities())

    @cached_property
    def classified(self) -> NDArray[np.uint8]:
        """(H, W) uint8: the class of every free cell by its own scan alone, as in ``labels``."""
        return _read_only(self._handle.classified())

    @cached_property
    def topology(self) -> Topology:
        """The topological map."""
        return Topology(self._handle.topology_json())

    @property
    def places(self) -> tuple[Place, ...]:
        """All places by number, doorways among them."""
        return self.topology.places

    @property
    def doorways(self) -> tuple[Doorway, ...]:
        """The places of the role doorway."""
        return self.topology.doorways

    @property
    def connections(self) -> tuple[Connection, ...]:
        """Which places touch, and the ways between them."""
        return self.topology.connections

    @property
    def findings(self) -> tuple[str, ...]:
        """What was noticed about the input, in plain words."""
        return tuple(self.topology.document.get("findings", ()))

    @cached_property
    def changes(self) -> tuple[dict[str, Any], ...]:
        """What changed since ``previous``: places that appeared, vanished, split or merged."""
        return tuple(json.loads(self._handle.changes_json()))

    def overview_png(self) -> bytes:
        """The overview as a PNG file: the map colored by class, outlines, the graph, a legend, a scale."""
        return self._handle.overview_png()

    def plot(self, ax: Axes | None = None, *, names: bool = True, graph: bool = True) -> Axes:
        """Draws the result into Matplotlib axes, in meters of the map frame, and returns them.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Where to draw; new axes by default.
        names : bool
            Whether places are named.
        graph : bool
            Whether the ways between places are drawn.
        """
        import matplotlib.pyplot as plt
        from matplotlib.lines import Line2D
        from matplotlib.patches import Patch
        from matplotlib.transforms import Affine2D

        if ax is None:
            ax = plt.subplots(figsize=(9, 9))[1]
        height, width = self.labels.shape
        colors = np.array([[255, 255, 255], *(each.color for each in self.classes)], dtype=np.uint8)
        pixels = colors[self.labels]
        occupancy = self.map.array
        pixels[occupancy == 100] = (40, 40, 40)
        pixels[occupancy == -1] = (224, 224, 224)
        resolution, (x, y, yaw) = self.map.resolution, self.map.origin
        extent = (0.0, width * resolution, 0.0, height * resolution)
        map_from_grid = Affine2D().rotate(yaw).translate(x, y)
        ax.imshow(pixels, extent=extent, interpolation="nearest", transform=map_from_grid + ax.transData)
        corners = map_from_grid.transform([(i, j) for i in extent[:2] for j in extent[2:]])
        ax.set(xlim=(corners[:, 0].min(), corners[:, 0].max()), ylim=(corners[:, 1].min(), corners[:, 1].max()))
        ax.set(aspect="equal", xlabel="x in m", ylabel="y in m", title=self.map.name)
        if graph:
            for connection in self.connections:
                if connection.line is not None:
                    ax.add_line(Line2D(connection.line[:, 0], connection.line[:, 1], color="black", linewidth=0.8))
        if names:
            for place in self.places:
                if not isinstance(place, Doorway):
                    ax.text(*place.anchor, place.name, ha="center", va="center", fontsize=7, clip_on=True)
        ax.legend(handles=[Patch(color=colors[k + 1] / 255, label=each.name) for k, each in enumerate(self.classes)])
        return ax

    def save(
        self,
        folder: Path,
        *,
        export: Iterable[str] = (),
        masks: Path | None = None,
        stages: bool = False,
        probabilities: bool = False,
        georeference: tuple[float, float, float] | None = None,
    ) -> list[str]:
        """Writes the files of ``placegraph map`` into ``folder``, the same bytes, and returns their paths.

        ``export`` names further formats (:func:`export_formats`), ``masks`` a file that says what costs and limits
        their masks have; ``stages`` and ``probabilities`` add the files of ``--stages`` and ``--probabilities``.
        ``georeference`` is where the map stands on Earth: latitude and longitude of the map frame's origin, and the
        heading of its y axis clockwise from true north, in degrees. All files are written, or none.
        """
        text = None if masks is None else os.fspath(masks)
        return self._handle.save(os.fspath(folder), _names(export), text, stages, probabilities, georeference)

    def export(
        self,
        format: str,
        path: Path,
        *,
        masks: Path | None = None,
        georeference: tuple[float, float, float] | None = None,
    ) -> list[str]:
        """Writes one format: to a file, or into an existing folder under its usual name. Returns the paths of its files.

        Raises :class:`ExportError` where the format cannot hold the map; :func:`export_formats` names the formats.
        ``georeference`` is that of :meth:`save`.
        """
        text = None if masks is None else os.fspath(masks)
        return self._handle.export(format, os.fspath(path), text, georeference)

    def __repr__(self) -> str:
        return f"Result({self.map.name!r}: {summary(self.topology)})"

    def _repr_png_(self) -> bytes:
        return self.overview_png()

    def _repr_html_(self) -> str:
        picture = base64.b64encode(self.overview_png()).decode()
        rows = "".join(
            f"<tr><td>{place.id}</td><td>{html.escape(place.name)}</td><td>{html.escape(place.class_name)}</td>"
            f"<td>{place.area_m2:.1f}</td><td>{place.probability:.2f}</td></tr>"
            for place in self.places
        )
        heads = "".join(f"<th>{name}</th>" for name in ("number", "name", "class", "area in m²", "probability"))
        title = html.escape(repr(self))
        return (
            f'<p>{title}</p><img alt="{title}" style="max-width: 100%" src="data:image/png;base64,{picture}">'
            f"<details><summary>{len(self.places)} places</summary>"
            f"<table><thead><tr>{heads}</tr></thead><tbody>{rows}</tbody></table></details>"
        )


def label(
    map: OccupancyGrid | Path,
    *,
    model: Model | Path | None = None,
    previous: Result | Topology | Path | None = None,
    edits: Path | None = None,
    doorways: bool = True,
    correction: bool = True,
    align: bool = False,
    hold: bool = False,
    robot_radius: float = 0.0,
    robot_at: tuple[float, float] | None = None,
    threads: int | None = None,
) -> Result:
    """Labels every free cell of a map and builds its topological map.

    The GIL is released meanwhile, and Ctrl-C ends the call. The same map and model give the same bits on any
    number of threads.

    Parameters
    ----------
    map : OccupancyGrid or path
        The map.
    model : Model or path, optional
        What to label with; by default the model that comes with the package.
    previous : Result, Topology or path, optional
        An earlier result: places that are still there keep its numbers and names.
    edits : path, optional
        A file of corrections by hand (docs/exports.md).
    doorways : bool
        Whether narrow passages become doorways and the spaces between them are labeled as a whole; else doorways
        are what the classifier says, as in the chapter.
    correction : bool
        Whether small regions, and doorways that join nothing, are relabeled.
    align : bool
        Whether ``previous`` is turned and shifted onto the map first, as after a new mapping session.
    hold : bool
        Whether the doorways and classes of ``previous`` are held on to: they go only with more evidence than is needed to decide
        anew. Not together with ``align``.
    robot_radius : float
        What the robot's center needs on all sides, in meters: routes and stations keep it.
    robot_at : (float, float), optional
        Where the robot is, in meters of the map frame: what cannot be reached from there is cut off. By default, what
        cannot be reached from the largest part.
    threads : int, optional
        Number of threads; by default one a core.

    Examples
    --------
    >>> import placegraph as pg
    >>> result = pg.label("maps/office/map.yaml")
    >>> result.labels.shape, result.labels.dtype
    ((464, 327), dtype('uint8'))
    >>> result.places[0]
    <'room 1': room, 28.4 m² at (-19.8, 3.1)>
    """
    return _label(
        as_map(map), as_model(model), None, previous, edits, doorways, correction, align, hold, robot_radius, robot_at, threads
    )


class Session:
    """Labels one map of a growing building after the other.

    Places keep their numbers and names, and labels do not flicker. Cells that see nothing new are not measured again, which saves
    most of the time where little changed. Every result is that of :func:`label` with the one before as ``previous`` and with
    ``hold``, to the bit.

    Parameters
    ----------
    model : Model or path, optional
        What to label with; by default the model that comes with the package.

    Examples
    --------
    >>> import placegraph as pg
    >>> session = pg.Session()
    >>> first = session.update("maps/home/map.yaml")
    >>> second = session.update("maps/home/map.yaml")
    >>> [place.id for place in first.places] == [place.id for place in second.places]
    True
    """

    def __init__(self, model: Model | Path | None = None) -> None:
        self._model = as_model(model)
        self._handle = _native.Session(self._model._handle)
        self._last: Topology | None = None

    def update(
        self,
        map: OccupancyGrid | Path,
        *,
        previous: Result | Topology | Path | None = None,
        edits: Path | None = None,
        doorways: bool = True,
        correction: bool = True,
        hold: bool = True,
        robot_radius: float = 0.0,
        robot_at: tuple[float, float] | None = None,
        threads: int | None = None,
    ) -> Result:
        """Labels the next map, with the parameters of :func:`label` but ``align``. ``previous`` is the last result unless given."""
        result = _label(
            as_map(map),
            self._model,
            self._handle,
            self._last if previous is None else previous,
            edits,
            doorways,
            correction,
            False,
            hold,
            robot_radius,
            robot_at,
            threads,
        )
        self._last = result.topology
        return result


def _label(
    grid: OccupancyGrid,
    trained: Model,
    session: _native.Session | None,
    previous: Result | Topology | Path | None,
    edits: Path | None,
    doorways: bool,
    correction: bool,
    align: bool,
    hold: bool,
    robot_radius: float,
    robot_at: tuple[float, float] | None,
    threads: int | None,
) -> Result:
    if align and hold:
        raise ValueError("expected align or hold, found both: what is in another frame cannot be held on to")
    if isinstance(previous, Result):
        previous = previous.topology
    earlier = None if previous is None else as_topology(previous)._json
    text = None if edits is None else os.fspath(edits)
    at = None if robot_at is None else (float(robot_at[0]), float(robot_at[1]))
    robot = (float(robot_radius), at)
    native = _native.label(
        grid._handle, trained._handle, earlier, text, doorways, correction, align, hold, robot, threads, session
    )
    return Result._of(native, grid, trained)


def export_formats() -> dict[str, str]:
    """The names of all formats of :meth:`Result.export`, and what each is."""
    return dict(_native.export_formats())


def _names(export: Iterable[str]) -> list[str]:
    return [export] if isinstance(export, str) else list(export)


def _read_only(array: NDArray[T]) -> NDArray[T]:
    array.flags.writeable = False
    return array
