"""Labels many maps with one engine or the other: the same tasks, the same parts, the same bytes."""

from __future__ import annotations

import glob
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Any, Literal, TypeAlias

import pyarrow as pa
import pyarrow.parquet as pq

from .._grid import Path
from .._model import Model
from ._tables import Row
from ._worker import TABLES, LabelMaps, Task, part_name, write_table

Maps: TypeAlias = "Iterable[Path] | Mapping[str, Path]"
Engine: TypeAlias = Callable[[LabelMaps, Sequence[Sequence[Task]], "int | None"], Iterator[list[Row]]]

LATEST = "latest.parquet"
"""The table that names the newest result of every site, and the part that has it."""


@dataclass(frozen=True)
class Summary:
    """What became of the maps of a run."""

    out: str
    """Folder of the data set."""
    n_labeled: int
    """Maps that were labeled."""
    n_kept: int
    """Maps whose results were there."""
    failed: dict[str, str] = field(repr=False)
    """The error of every map that could not be labeled, by site."""

    def __str__(self) -> str:
        return f"{self.n_labeled} labeled, {self.n_kept} kept, {len(self.failed)} failed; in {self.out}"


def label_maps(
    maps: Maps,
    out: Path,
    *,
    engine: Literal["local", "ray", "dask"] = "local",
    model: Model | Path | None = None,
    previous: Path | None = None,
    doorways: bool = True,
    correction: bool = True,
    workers: int | None = None,
    maps_per_part: int = 32,
    on_part: Callable[[list[dict[str, Any]]], None] | None = None,
) -> Summary:
    """Labels maps into a GeoParquet data set: the tables ``maps``, ``places``, ``doorways``, ``connections``.

    A result goes by the hash of its map, model, options, version, and the earlier result that names came from. What
    the data set has is not done again, so a run that was ended is completed by the next one. A map that cannot be
    labeled is a row with its error. Rows and bytes do not depend on the engine or on the number of workers.

    Parameters
    ----------
    maps : iterable of paths or URLs, or mapping from site to path or URL
        The maps. A site is what a map is called from run to run: by default the name of its file without extension,
        or, where that is ``map``, the name of its folder. URLs other than ``file:`` need fsspec.
    out : path
        Folder of the data set; with an engine of several machines a folder that all of them share.
    engine : {"local", "ray", "dask"}
        Threads of this process; the Ray cluster that this process is connected to or that ``RAY_ADDRESS`` names, or a
        new local one; the current Dask client, or a new local cluster.
    model : Model or path, optional
        What to label with; by default the model that comes with the package.
    previous : path, optional
        Data set of an earlier run: places keep its numbers and names, site by site.
    doorways, correction : bool
        As for :func:`placegraph.label`.
    workers : int, optional
        Maps that are labeled at a time, one thread each; by default one a core.
    maps_per_part : int
        Maps that a worker takes at a time, and whose rows share a file.
    on_part : callable, optional
        Is told what became of the maps of every part: ``site``, ``map``, ``key``, ``status``, ``error``.
    """
    sites = _sites(maps)
    folder = os.path.abspath(os.fspath(out))
    if maps_per_part < 1 or (workers is not None and workers < 1):
        raise ValueError(f"expected at least 1 worker and map per part, found {workers} and {maps_per_part}")
    run = _engine(engine)
    os.makedirs(folder, exist_ok=True)
    _remove_unfinished(folder)
    known = {} if previous is None else _latest(os.path.abspath(os.fspath(previous)))
    tasks = [Task(site, map, *known.get(site, (None, None))) for site, map in sites.items()]
    worker = LabelMaps(folder, model=model, doorways=doorways, correction=correction, done=_keys(folder))
    parts = [tasks[start : start + maps_per_part] for start in range(0, len(tasks), maps_per_part)]
    outcomes: dict[str, Row] = {}
    for rows in run(worker, parts, workers):
        outcomes.update((row["site"], row) for row in rows)
        if on_part is not None:
            on_part(rows)
    _write_latest(folder, outcomes)
    of = [row["status"] for row in outcomes.values()]
    failed = {site: outcomes[site]["error"] for site in sites if outcomes[site]["status"] == "failed"}
    return Summary(folder, of.count("labeled"), of.count("kept"), failed)


def _local(worker: LabelMaps, parts: Sequence[Sequence[Task]], workers: int | None) -> Iterator[list[Row]]:
    # Labeling runs without the GIL: threads are enough, and nothing is copied.
    with ThreadPoolExecutor(workers or os.cpu_count() or 1, thread_name_prefix="placegraph") as pool:
        futures = [pool.submit(worker.label, part) for part in parts]
        try:
            for future in futures:
                yield future.result()
        finally:
            for future in futures:
                future.cancel()


def _ray(worker: LabelMaps, parts: Sequence[Sequence[Task]], workers: int | None) -> Iterator[list[Row]]:
    import ray

    if not ray.is_initialized():
        # Named, one of both: Ray would join any cluster that it finds traces of, and refuse a number of workers there.
        if os.environ.get("RAY_ADDRESS"):
            ray.init(log_to_driver=False)
        else:
            ray.init(address="local", num_cpus=workers, log_to_driver=False)
    # A task per part, done again where its machine is lost: it writes the same files.
    label = ray.remote(num_cpus=1, max_retries=-1)(_label)
    shared = ray.put(worker)
    waiting = list(parts)[::-1]
    most = 2 * (workers or int(ray.cluster_resources().get("CPU", 1)))
    running: list[Any] = []
    while waiting or running:
        while waiting and len(running) < (workers or most):
            running.append(label.remote(shared, waiting.pop()))
        (done, *_), running = ray.wait(running, num_returns=1)
        yield ray.get(done)


def _dask(worker: LabelMaps, parts: Sequence[Sequence[Task]], workers: int | None) -> Iterator[list[Row]]:
    from distributed import Client, LocalCluster, as_completed, get_client

    try:
        client, own = get_client(), None
    except ValueError:
        n = workers or os.cpu_count() or 1
        own = LocalCluster(n_workers=n, threads_per_worker=1, dashboard_address=None)
        client = Client(own)
    try:
        shared = client.scatter(worker, broadcast=True)
        futures = [client.submit(_label, shared, part, pure=False, retries=3) for part in parts]
        for future in as_completed(futures):
            yield future.result()
            future.release()
    finally:
        if own is not None:
            client.close()
            own.close()


def _label(worker: LabelMaps, tasks: Sequence[Task]) -> list[Row]:
    return worker.label(tasks)


_ENGINES: dict[str, Engine] = {"local": _local, "ray": _ray, "dask": _dask}


def _engine(name: str) -> Engine:
    if name not in _ENGINES:
        raise ValueError(f"expected engine to be one of {', '.join(_ENGINES)}, found {name!r}")
    return _ENGINES[name]


def _sites(maps: Maps) -> dict[str, str]:
    if isinstance(maps, (str, os.PathLike)):
        raise TypeError(f"expected several maps, found one path: {os.fspath(maps)!r}")
    if isinstance(maps, Mapping):
        return {str(site): os.fspath(map) for site, map in maps.items()}
    sites: dict[str, str] = {}
    for map in map_paths(maps):
        site = site_of(map)
        if sites.get(site, map) != map:
            raise ValueError(
                f"{sites[site]} and {map} would both be the site {site!r}: give a mapping from site to map"
            )
        sites[site] = map
    return sites


def map_paths(maps: Iterable[Path]) -> Iterator[str]:
    """``maps`` as text; local ones are absolute, because workers have other working folders."""
    for each in maps:
        path = os.fspath(each)
        yield path if "://" in path else os.path.abspath(path)


def site_of(map: str) -> str:
    """What a map is called from run to run."""
    folder, _, file = map.replace(os.sep, "/").rpartition("/")
    stem = file.rpartition(".")[0] or file
    return folder.rpartition("/")[2] if stem == "map" and folder else stem


def _remove_unfinished(folder: str) -> None:
    """Removes what a run that was ended left: files half written, and parts that ``maps`` does not vouch for."""
    whole = {os.path.basename(path) for path in glob.glob(os.path.join(glob.escape(folder), "maps", "part-*.parquet"))}
    for table in TABLES:
        inside = os.path.join(glob.escape(folder), table)
        for path in glob.glob(os.path.join(inside, ".part-*")):
            os.unlink(path)
        for path in glob.glob(os.path.join(inside, "part-*.parquet")):
            if os.path.basename(path) not in whole:
                os.unlink(path)


def _parts(folder: str) -> list[str]:
    return sorted(glob.glob(os.path.join(glob.escape(folder), "maps", "part-*.parquet")))


def _keys(folder: str) -> set[str]:
    """The keys of all results, and of all failures, of a data set."""
    return {key for part in _parts(folder) for key in pq.read_table(part, columns=["key"]).column("key").to_pylist()}


def _latest(folder: str) -> dict[str, tuple[str, str]]:
    """The part and the key of the newest result of every site."""
    path = os.path.join(folder, LATEST)
    if not os.path.exists(path):
        raise FileNotFoundError(f"expected the data set of an earlier run with {LATEST}, found none in {folder}")
    rows = pq.read_table(path, columns=["site", "key", "part"], filters=[("status", "!=", "failed")]).to_pylist()
    return {row["site"]: (os.path.join(folder, "maps", row["part"]), row["key"]) for row in rows}


def _write_latest(folder: str, outcomes: Mapping[str, Row]) -> None:
    part_of: dict[str, str] = {}
    for part in _parts(folder):
        keys = pq.read_table(part, columns=["key"]).column("key").to_pylist()
        part_of.update(dict.fromkeys(keys, os.path.basename(part)))
    names = ("site", "map", "key", "status", "error")
    rows = [
        {name: row[name] for name in names} | {"status": row["status"].replace("kept", "labeled"), "part": part_of.get(row["key"])}
        for _, row in sorted(outcomes.items())
    ]
    schema = pa.schema([(name, pa.string()) for name in (*names, "part")])
    write_table(pa.Table.from_pylist(rows, schema=schema), os.path.join(folder, LATEST))


__all__ = ["Summary", "label_maps", "part_name"]
