"""What the tests share."""

from __future__ import annotations

import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import placegraph as pg
import pytest

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]
"""The repository, for its example maps."""

sys.path.insert(0, str(HERE.parent))


def occupancy_message(cells: Any, resolution: float = 0.05, origin: Any = (0.0, 0.0, 0.0), frame_id: str = "map") -> Any:
    """What a reader sees of a nav_msgs/OccupancyGrid; `cells` have their lowest row first."""
    cells = np.asarray(cells, np.int8)
    x, y, yaw = origin
    return SimpleNamespace(
        header=SimpleNamespace(frame_id=frame_id),
        info=SimpleNamespace(
            resolution=float(np.float32(resolution)),
            width=cells.shape[1],
            height=cells.shape[0],
            origin=SimpleNamespace(
                position=SimpleNamespace(x=x, y=y, z=0.0),
                orientation=SimpleNamespace(x=0.0, y=0.0, z=float(np.sin(yaw / 2)), w=float(np.cos(yaw / 2))),
            ),
        ),
        data=cells.reshape(-1).tolist(),
    )


def map_message(map: pg.OccupancyGrid, frame_id: str = "map") -> Any:
    """A map as a map server would send it."""
    return occupancy_message(map.array[::-1], map.resolution, map.origin, frame_id)


@pytest.fixture(scope="session")
def home() -> pg.OccupancyGrid:
    return pg.load_map(ROOT / "maps/home/map.yaml")


@pytest.fixture(scope="session")
def home_result(home: pg.OccupancyGrid) -> pg.Result:
    return pg.label(home)
