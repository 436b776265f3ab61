"""Labels some maps and writes their rows: stateless but for what it was made with, and picklable."""

from __future__ import annotations

import hashlib
import os
import re
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any
from urllib.parse import unquote, urlparse

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from .._grid import OccupancyGrid, load_map
from .._model import Model, as_model
from .._native import VERSION
from .._result import label
from .._topology import Topology
from ..errors import Error
from ._tables import SCHEMAS, Row, outline_of, rows_of, table_of

TABLES = ("places", "doorways", "connections", "maps")
"""The tables of a data set; ``maps`` is written last and vouches for the others."""


@dataclass(frozen=True)
class Options:
    """What results depend on besides map, model and version."""

    doorways: bool = True
    correction: bool = True

    def __str__(self) -> str:
        off = [name for name, is_on in (("doorways", self.doorways), ("correction", self.correction)) if not is_on]
        return " ".join(f"no-{name}" for name in off)


@dataclass(frozen=True)
class Task:
    """A map to be labeled, and the part of an earlier data set that has its site."""

    site: str
    map: str
    previous_part: str | None = None
    previous_key: str | None = None


class LabelMaps:
    """Labels maps one after the other, on one thread, and writes their rows as one part of the data set.

    For ``ray.data``: ``dataset.map_batches(LabelMaps, fn_constructor_kwargs={"out": folder})`` on batches with a column
    ``map`` of paths or URLs, and optionally ``site``; the batches that come back say what became of every map. Every
    worker must reach ``out``, which is a folder that they share.

    Parameters
    ----------
    out : str
        Folder of the data set.
    model : Model or path, optional
        What to label with.
    doorways, correction : bool
        As for :func:`placegraph.label`.
    done : collection of str
        Keys of results that the data set already has.
    """

    def __init__(
        self,
        out: str | os.PathLike[str],
        *,
        model: Model | str | os.PathLike[str] | None = None,
        doorways: bool = True,
        correction: bool = True,
        done: Iterable[str] = (),
    ) -> None:
        self.out = os.fspath(out)
        self.model = as_model(model)
        self.options = Options(doorways, correction)
        self.done = frozenset(done)

    def __call__(self, batch: Mapping[str, Any]) -> dict[str, Any]:
        """Labels the maps of a batch of columns."""
        maps = [str(each) for each in batch["map"]]
        sites = [str(each) for each in batch["site"]] if "site" in batch else maps
        rows = self.label([Task(site, map) for site, map in zip(sites, maps)])
        return {name: np.array([row[name] or "" for row in rows], dtype=object) for name in Outcome.columns}

    def label(self, tasks: Sequence[Task]) -> list[Row]:
        """Labels the maps of ``tasks``, writes what is new, and says what became of each."""
        outcomes, part = [], Part()
        for task in tasks:
            map_row, others = self._one(task)
            is_new = map_row["key"] not in self.done and map_row["key"] not in part.keys
            if is_new:
                part.add(map_row, others)
            status = map_row["status"]
            kept = status == "labeled" and not is_new
            outcomes.append({name: map_row.get(name) for name in Outcome.columns} | {"status": "kept" if kept else status})
        part.write(self.out)
        return outcomes

    def _one(self, task: Task) -> tuple[Row, dict[str, list[Row]]]:
        head: Row = {"site": task.site, "map": task.map, "version": VERSION, "options": str(self.options)}
        head |= {"model": self.model.name, "model_hash": self.model.hash}
        try:
            map = _load(task.map)
            head["map_hash"] = map.hash
            head["key"] = self._key(task.site, map.hash, task.previous_key or "")
            if head["key"] in self.done:
                return head | {"status": "labeled"}, {}
            previous = _previous(task)
            result = label(
                map,
                model=self.model,
                previous=previous,
                doorways=self.options.doorways,
                correction=self.options.correction,
                threads=1,
            )
            topology = result.topology
            height, width = map.shape
            row = head | {
                "status": "labeled",
                "resolution_m": map.resolution,
                "width": width,
                "height": height,
                "n_places": len(topology.places),
                "n_doorways": len(topology.doorways),
                "n_connections": len(topology.connections),
                "area_m2": sum(place.area_m2 for place in topology.places),
                "findings": list(result.findings),
                "topology": topology.to_json(),
                "geometry": outline_of(map),
            }
            return row, rows_of(head["key"], task.site, map, topology)
        except (Error, OSError, ValueError) as error:
            key = self._key(task.site, "failed", task.map, str(error))
            return head | {"key": key, "status": "failed", "error": str(error)}, {}

    def _key(self, *parts: str) -> str:
        """What a result goes by: the hash of all that it depends on."""
        text = "\0".join((VERSION, str(self.options), self.model.hash, *parts))
        return hashlib.sha256(text.encode()).hexdigest()[:32]


class Outcome:
    """What is said of a map once it was looked at."""

    columns = ("site", "map", "key", "status", "error")


@dataclass
class Part:
    """Rows of some maps, to be written as one file per table."""

    keys: list[str] = field(default_factory=list)
    rows: dict[str, list[Row]] = field(default_factory=lambda: {name: [] for name in TABLES})

    def add(self, map_row: Row, others: Mapping[str, list[Row]]) -> None:
        """Adds the rows of a map."""
        self.keys.append(map_row["key"])
        self.rows["maps"].append(map_row)
        for name, rows in others.items():
            self.rows[name].extend(rows)

    def write(self, out: str) -> None:
        """Writes the files, that of ``maps`` last. The same maps give the same names: done again, they are replaced."""
        if not self.keys:
            return
        name = part_name(self.keys)
        for table in TABLES:
            write_table(table_of(table, self.rows[table]), os.path.join(out, table, name))


def part_name(keys: Sequence[str]) -> str:
    """The name of the part that holds ``keys``."""
    return f"part-{hashlib.sha256(' '.join(keys).encode()).hexdigest()[:16]}.parquet"


def write_table(table: pa.Table, path: str) -> None:
    """Writes a Parquet file, whole or not at all."""
    os.makedirs(os.path.dirname(path), exist_ok=True)
    handle, unfinished = tempfile.mkstemp(dir=os.path.dirname(path), prefix=".part-")
    try:
        os.close(handle)
        pq.write_table(table, unfinished, compression="zstd")
        os.chmod(unfinished, 0o644)
        os.replace(unfinished, path)
    except BaseException:
        os.unlink(unfinished)
        raise


def _previous(task: Task) -> Topology | None:
    if task.previous_part is None:
        return None
    table = pq.read_table(task.previous_part, columns=["topology"], filters=[("key", "=", task.previous_key)])
    return Topology(table.column("topology")[0].as_py())


def _load(map: str) -> OccupancyGrid:
    """The map at a path or a URL."""
    address = urlparse(map)
    if address.scheme == "file":
        return load_map(unquote(address.path))
    if len(address.scheme) < 2:
        return load_map(map)
    return _download(map)


_IMAGE = re.compile(r"""^image\s*:\s*["']?([^"'#\n]+?)["']?\s*(?:#.*)?$""", re.MULTILINE)


def _download(url: str) -> OccupancyGrid:
    """The map at a URL that fsspec opens: s3://, gs://, https:// ..., with the image that its YAML file names beside it."""
    import fsspec

    filesystem, path = fsspec.core.url_to_fs(url)
    folder, _, name = path.rpartition("/")
    with tempfile.TemporaryDirectory(prefix="placegraph-") as scratch:
        local = os.path.join(scratch, name)
        filesystem.get_file(path, local)
        if name.lower().endswith((".yaml", ".yml")):
            with open(local, encoding="utf-8", errors="replace") as file:
                named = _IMAGE.search(file.read(1 << 20))
            if named and os.path.basename(named[1]) == named[1]:
                filesystem.get_file(f"{folder}/{named[1]}", os.path.join(scratch, named[1]))
        return load_map(local)


__all__ = ["SCHEMAS", "TABLES", "LabelMaps", "Task"]
