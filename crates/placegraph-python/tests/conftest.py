"""What the tests share: run by `.ci/run python` against the built wheel, never against the source tree."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

import placegraph as pg

ROOT = Path(__file__).resolve().parents[3]
"""The repository: doctests and pages name maps from here."""


@pytest.fixture(autouse=True, scope="session")
def _in_repository() -> None:
    os.chdir(ROOT)
    os.environ["SOURCE_DATE_EPOCH"] = "0"


@pytest.fixture(scope="session")
def office() -> pg.OccupancyGrid:
    return pg.load_map(ROOT / "maps/office/map.yaml")


@pytest.fixture(scope="session")
def result(office: pg.OccupancyGrid) -> pg.Result:
    return pg.label(office)


@pytest.fixture(scope="session")
def program() -> Callable[..., subprocess.CompletedProcess[str]]:
    """Runs the program that cargo built: PLACEGRAPH_PROGRAM names it."""
    path = os.environ.get("PLACEGRAPH_PROGRAM")
    if path is None:
        pytest.skip("PLACEGRAPH_PROGRAM does not name the program that cargo built")

    def run(*args: object) -> subprocess.CompletedProcess[str]:
        return subprocess.run([path, *map(str, args)], capture_output=True, text=True, check=False)

    return run


def files_of(folder: Path) -> dict[str, bytes]:
    """The content of every file in a folder."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}
