"""Ray and Dask give the bytes of one machine, also when a node is lost. Slow: `.ci/run python` runs them where they install.

Both look for their own address by opening a socket to a far one: the tests run in a network namespace without one.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import placegraph as pg
from conftest import files_of

pytest.importorskip("pyarrow")
from placegraph import fleet  # noqa: E402

HERE = Path(__file__).parent


@pytest.fixture(scope="module")
def sites(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("sites")
    n = int(os.environ.get("PLACEGRAPH_N_FLEET", "12"))
    paths = {}
    for index in range(n):
        building = pg.generate(style="home", seed=6, index=index, mapping="clean", resolution=0.1)
        paths[f"site{index:03}"] = building.save(folder / f"site{index:03}")
    (folder / "sites.json").write_text(json.dumps(paths))
    return folder / "sites.json"


@pytest.fixture(scope="module")
def local(sites: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    out = tmp_path_factory.mktemp("local")
    fleet.label_maps(json.loads(sites.read_text()), out, maps_per_part=2)
    return files_of(out)


@pytest.mark.parametrize("engine", ["ray", "ray-node-lost", "dask", "dask-worker-lost"])
def test_a_cluster_gives_the_same_bytes(engine: str, sites: Path, local: dict[str, bytes], tmp_path: Path) -> None:
    pytest.importorskip("ray" if engine.startswith("ray") else "distributed")
    inside = [sys.executable, HERE / "run_on_cluster.py", engine, sites, tmp_path / "out"]
    namespace = ["unshare", "-rn", "sh", "-c", 'ip link set lo up 2>/dev/null || ifconfig lo up; exec "$@"', "sh"]
    if subprocess.run([*namespace, "true"], capture_output=True, check=False).returncode != 0:
        pytest.skip("no network namespace can be made here")
    environment = os.environ | {"RAY_USAGE_STATS_ENABLED": "0", "PYTHONWARNINGS": "ignore"}
    done = subprocess.run([*namespace, *inside], env=environment, capture_output=True, text=True, timeout=580, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert files_of(tmp_path / "out") == local
