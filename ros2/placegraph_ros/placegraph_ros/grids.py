"""Occupancy grids of ROS as arrays, and arrays as occupancy grids."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import placegraph as pg
from numpy.typing import NDArray

UNKNOWN = -1


@dataclass(frozen=True)
class GridData:
    """The content of a ``nav_msgs/OccupancyGrid``, whose row 0 is the *lowest* one."""

    frame_id: str
    resolution: float
    """Side of a cell in meters."""
    origin: tuple[float, float, float]
    """x and y in meters and yaw in radians of the lower left corner."""
    cells: NDArray[np.int8]
    """(height, width) int8."""

    def is_same_map(self, other: GridData | None) -> bool:
        """Whether both hold the same values at the same place."""
        return (
            other is not None
            and (self.frame_id, self.resolution, self.origin) == (other.frame_id, other.resolution, other.origin)
            and np.array_equal(self.cells, other.cells)
        )

    def to_map(self, *, name: str, occupied_thresh: float, free_thresh: float) -> pg.OccupancyGrid:
        """The map that placegraph labels. Raises :class:`placegraph.MapError` if a value is not -1 to 100."""
        return pg.OccupancyGrid(
            self.cells[::-1],
            resolution=self.resolution,
            origin=self.origin,
            name=name,
            occupied_thresh=occupied_thresh,
            free_thresh=free_thresh,
        )

    def with_cells(self, top_down: NDArray[Any]) -> GridData:
        """The same place with other values, given with row 0 at the top."""
        return replace(self, cells=np.ascontiguousarray(top_down[::-1], dtype=np.int8))


def read_grid(message: Any) -> GridData:
    """The content of a ``nav_msgs/OccupancyGrid``.

    The message has the resolution as a 32-bit float. It is read as the shortest decimal number that rounds to it:
    0.05, not 0.05000000074505806, so that results are those of the map's file. The yaw is rounded to 1e-12 rad
    for the same reason.

    Raises
    ------
    placegraph.MapError
        If the message is no map: no cells, cells missing, no resolution, a grid that does not lie flat.
    """
    info = message.info
    width, height = int(info.width), int(info.height)
    if width == 0 or height == 0:
        raise pg.MapError(f"the map has no cells: it is {width} x {height}")
    data = _cells(message.data)
    if data.size != width * height:
        raise pg.MapError(f"expected {width} x {height} = {width * height} cells, found {data.size}")
    resolution = float(str(np.float32(info.resolution)))
    if not (math.isfinite(resolution) and resolution > 0):
        raise pg.MapError(f"expected a resolution above 0 m, found {resolution:g}")
    position = info.origin.position
    origin = (float(position.x), float(position.y), round(yaw_of(info.origin.orientation), 12))
    if not all(map(math.isfinite, origin)):
        raise pg.MapError(f"expected finite numbers as the map's origin, found {origin}")
    # An empty frame is what a program sends that does not fill the header.
    return GridData(message.header.frame_id or "map", resolution, origin, data.reshape(height, width))


def yaw_of(orientation: Any) -> float:
    """Yaw in radians of a rotation about z. Raises :class:`placegraph.MapError` for any other rotation."""
    x, y, z, w = (float(getattr(orientation, axis)) for axis in "xyzw")
    if (x, y, z, w) == (0.0, 0.0, 0.0, 0.0):
        return 0.0  # the message was not filled
    norm = math.sqrt(x * x + y * y + z * z + w * w)
    if not math.isfinite(norm) or abs(norm - 1) > 0.01:
        raise pg.MapError(f"expected a unit quaternion as the map's orientation, found ({x:g}, {y:g}, {z:g}, {w:g})")
    if math.hypot(x, y) > 0.01:
        raise pg.MapError("expected a map that lies flat, found one that is tilted out of the x-y plane")
    return 2 * math.atan2(z, w) if w >= 0 else 2 * math.atan2(-z, -w)


def apply_update(grid: GridData, update: Any) -> GridData:
    """The map after a ``map_msgs/OccupancyGridUpdate``. Raises :class:`placegraph.MapError` if it does not fit."""
    x, y, width, height = (int(getattr(update, name)) for name in ("x", "y", "width", "height"))
    rows, columns = grid.cells.shape
    if x < 0 or y < 0 or width < 0 or height < 0 or x + width > columns or y + height > rows:
        raise pg.MapError(
            f"an update of {width} x {height} cells at ({x}, {y}) does not lie in the map of {columns} x {rows} cells"
        )
    patch = _cells(update.data)
    if patch.size != width * height:
        raise pg.MapError(f"expected an update of {width} x {height} cells, found {patch.size}")
    cells = grid.cells.copy()
    cells[y : y + height, x : x + width] = patch.reshape(height, width)
    return replace(grid, cells=cells)


def label_cells(labels: NDArray[np.uint8]) -> NDArray[np.int8]:
    """Labels as values of a grid: k for the k-th class, -1 where there is no free cell."""
    return np.where(labels == 0, UNKNOWN, labels).astype(np.int8)


def region_cells(regions: NDArray[np.uint32]) -> NDArray[np.int8]:
    """Numbers of places as values of a grid, from 1 to 100 and then from 1 again; -1 where there is no place."""
    return np.where(regions == 0, UNKNOWN, (regions.astype(np.int64) - 1) % 100 + 1).astype(np.int8)


def mask_cells(pixels: NDArray[np.uint8]) -> NDArray[np.int8]:
    """The values of a mask whose image has the mode raw."""
    return np.where(pixels > 100, UNKNOWN, pixels).astype(np.int8)


def _cells(data: Any) -> NDArray[np.int8]:
    # rclpy gives an array.array, whose memory is read as it is.
    return np.asarray(data, dtype=np.int8).reshape(-1)
