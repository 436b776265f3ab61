"""Messages to maps and back."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import placegraph as pg
import pytest
from conftest import map_message, occupancy_message

from placegraph_ros.grids import apply_update, label_cells, mask_cells, read_grid, region_cells, yaw_of


def test_a_message_gives_the_map_of_the_file(home: pg.OccupancyGrid) -> None:
    """The message has a 32-bit resolution and a quaternion, the file decimal numbers: both give the same labels."""
    grid = read_grid(map_message(home))
    assert (grid.resolution, grid.origin) == (home.resolution, home.origin)
    map = grid.to_map(name="map", occupied_thresh=0.65, free_thresh=0.196)
    np.testing.assert_array_equal(map.array, home.array)


@pytest.mark.parametrize("resolution", [0.05, 0.025, 0.1, 0.03, 1 / 3, 0.0500012])
def test_resolutions_are_the_shortest_decimals(resolution: float) -> None:
    read = read_grid(occupancy_message([[0]], resolution)).resolution
    assert np.float32(read) == np.float32(resolution)
    assert len(repr(read)) <= 12


@pytest.mark.parametrize("yaw", [0.0, 0.6, -2.5, 3.0, math.pi / 2])
@pytest.mark.parametrize("sign", [1, -1])
def test_yaw_of_both_quaternions_of_a_rotation(yaw: float, sign: int) -> None:
    turn = SimpleNamespace(x=0.0, y=0.0, z=sign * math.sin(yaw / 2), w=sign * math.cos(yaw / 2))
    assert yaw_of(turn) == pytest.approx(yaw, abs=1e-12)
    origin = (1.25, -3.5, yaw)
    if sign == 1:
        assert read_grid(occupancy_message([[0]], origin=origin)).origin == (1.25, -3.5, round(yaw, 12))


def test_an_orientation_that_was_not_filled_is_none() -> None:
    assert yaw_of(SimpleNamespace(x=0.0, y=0.0, z=0.0, w=0.0)) == 0


def broken(**changes: Any) -> Any:
    message = occupancy_message(np.zeros((2, 3)))
    for path, value in changes.items():
        *parents, name = path.split("__")
        target = message
        for parent in parents:
            target = getattr(target, parent)
        setattr(target, name, value)
    return message


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"info__width": 0, "info__height": 0, "data": []}, "no cells"),
        ({"info__width": 0, "data": []}, "0 x 2"),
        ({"data": [0] * 5}, "expected 3 x 2 = 6 cells, found 5"),
        ({"info__resolution": 0.0}, "resolution above 0"),
        ({"info__resolution": -0.05}, "resolution above 0"),
        ({"info__resolution": math.nan}, "resolution above 0"),
        ({"info__resolution": math.inf}, "resolution above 0"),
        ({"info__origin__position__x": math.nan}, "finite"),
        ({"info__origin__orientation__w": 7.0}, "unit quaternion"),
        ({"info__origin__orientation__w": math.nan}, "unit quaternion"),
        ({"info__origin__orientation__x": 1.0, "info__origin__orientation__w": 0.0}, "flat"),
    ],
)
def test_bad_messages_say_what_is_wrong(changes: dict[str, Any], text: str) -> None:
    with pytest.raises(pg.MapError, match=text):
        read_grid(broken(**changes))


def test_values_outside_of_the_range_are_refused() -> None:
    grid = read_grid(occupancy_message([[0, 101], [-1, 0]]))
    with pytest.raises(pg.MapError, match="101"):
        grid.to_map(name="map", occupied_thresh=0.65, free_thresh=0.196)


def test_updates_lie_where_they_say() -> None:
    grid = read_grid(occupancy_message(np.zeros((3, 4))))
    update = SimpleNamespace(x=1, y=2, width=2, height=1, data=[100, -1])
    cells = apply_update(grid, update).cells
    np.testing.assert_array_equal(cells, [[0, 0, 0, 0], [0, 0, 0, 0], [0, 100, -1, 0]])
    assert grid.cells.max() == 0, "the map before is as it was"
    for wrong in [{"x": 3}, {"y": 3}, {"x": -1}, {"data": [1]}]:
        with pytest.raises(pg.MapError):
            apply_update(grid, SimpleNamespace(**{**vars(update), **wrong}))


def test_values_of_grids() -> None:
    np.testing.assert_array_equal(label_cells(np.array([[0, 1, 3]], np.uint8)), [[-1, 1, 3]])
    regions = np.array([[0, 1, 100, 101, 250, 2**31]], np.uint32)
    np.testing.assert_array_equal(region_cells(regions), [[-1, 1, 100, 1, 50, (2**31 - 1) % 100 + 1]])
    np.testing.assert_array_equal(mask_cells(np.array([[0, 50, 100, 255]], np.uint8)), [[0, 50, 100, -1]])


def test_rows_are_turned_once() -> None:
    grid = read_grid(occupancy_message([[0, 0], [100, 100]]))
    top_down = grid.to_map(name="map", occupied_thresh=0.65, free_thresh=0.196).array
    np.testing.assert_array_equal(top_down, [[100, 100], [0, 0]])
    np.testing.assert_array_equal(grid.with_cells(top_down).cells, grid.cells)
