"""Throughput of a fleet's maps: the program's own batch beside local threads, Ray and Dask, by number of workers.

    pip install WHEEL[ray,dask]
    python crates/placegraph-python/benches/fleet.py target/release/placegraph FOLDER [N_MAPS]

FOLDER takes the maps: generated homes and, with PLACEGRAPH_DATA, for a quarter the smallest real maps of its `eval`. Start-up of a
cluster is not counted. Prints a Markdown table, and what 100 000 such maps would take on 64 cores.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

N_WORKERS = (1, 2)
ALONE = ["unshare", "-rn", "sh", "-c", 'ip link set lo up; exec "$@"', "sh"]


def make_maps(folder: Path, n_maps: int) -> list[str]:
    import placegraph as pg

    data = os.environ.get("PLACEGRAPH_DATA")
    real = sorted(Path(data, "eval").glob("*/map.yaml"), key=lambda path: (path.with_suffix(".png").stat().st_size, path)) if data else []
    maps = [str(path) for path in real[: n_maps // 4]]
    for index in range(n_maps - len(maps)):
        path = folder / f"home{index:03}/map.yaml"
        if not path.exists():
            pg.generate(style="home", seed=6, index=index, mapping="clean", resolution=0.1).save(path.parent)
        maps.append(str(path))
    return maps


def batch(program: str, maps: list[str], out: Path, n_workers: int) -> float:
    """Seconds of `map` over all maps, without the start of the program, which is a millisecond."""
    started = time.monotonic()
    done = subprocess.run([program, "map", *maps, "--out", out, "--threads", str(n_workers)], capture_output=True, text=True)
    if done.returncode not in (0, 1):
        sys.exit(done.stderr)
    return time.monotonic() - started


def engine_seconds(engine: str, maps: list[str], out: Path, n_workers: int) -> float:
    """Seconds of `label_maps` after the cluster has started and every worker has loaded the package."""
    from placegraph import fleet

    sites = {f"site{n:03}": map for n, map in enumerate(maps)}
    warm = dict(list(sites.items())[-2 * n_workers:])
    options = dict(engine=engine, workers=n_workers, maps_per_part=4)
    if engine == "dask":
        from distributed import Client, LocalCluster

        Client(LocalCluster(n_workers=n_workers, threads_per_worker=1, dashboard_address=None))
    fleet.label_maps(warm, out / "warm", **{**options, "maps_per_part": 1})
    started = time.monotonic()
    summary = fleet.label_maps(sites, out / "all", **options)
    seconds = time.monotonic() - started
    assert summary.n_labeled == len(maps), summary
    return seconds


def main(program: str, folder: Path, n_maps: int) -> None:
    maps = make_maps(folder, n_maps)
    print(f"{len(maps)} maps, {sum(not map.startswith(str(folder)) for map in maps)} of them real\n")
    print("| workers | maps a second: program | local threads | Ray | Dask |\n|---|---|---|---|---|")
    best = 0.0
    for n_workers in N_WORKERS:
        rates = [len(maps) / batch(program, maps, folder / "program", n_workers)]
        for engine in ["local", "ray", "dask"]:
            environment = os.environ | {"RAY_USAGE_STATS_ENABLED": "0", "RAY_worker_niceness": "0", "PYTHONWARNINGS": "ignore"}
            command = [*ALONE, sys.executable, __file__, "--engine", engine, json.dumps(maps), folder / "out", str(n_workers)]
            done = subprocess.run(command, capture_output=True, text=True, env=environment)
            if done.returncode != 0:
                sys.exit(done.stdout + done.stderr)
            rates.append(len(maps) / float(done.stdout.split()[-1]))
            shutil.rmtree(folder / "out")
            best = max(best, rates[-1] / n_workers) if engine == "ray" else best
        shutil.rmtree(folder / "program")
        print(f"| {n_workers} | {rates[0]:.2f} | " + " | ".join(f"{rate:.2f} ({rate / rates[0]:.2f} x)" for rate in rates[1:]) + " |", flush=True)
    print(f"\nOn Ray, 100 000 such maps on 64 cores: {100_000 / best / 64 / 60:.0f} min, if workers do not wait for disks.")


if __name__ == "__main__":
    if sys.argv[1] == "--engine":
        _, _, name, all_maps, into, count = sys.argv
        print(engine_seconds(name, json.loads(all_maps), Path(into), int(count)))
    else:
        main(sys.argv[1], Path(sys.argv[2]), int(sys.argv[3]) if len(sys.argv) > 3 else 200)
