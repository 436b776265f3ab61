"""Occupancy grid maps: from files and from arrays."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from .errors import MapError

if TYPE_CHECKING:
    from ._model import Model

Path: TypeAlias = "str | os.PathLike[str]"


@dataclass(frozen=True)
class Finding:
    """One thing that the check of a map found.

    ``severity`` is ``"info"``, ``"warning"`` (the result may be wrong) or ``"error"`` (there is nothing to
    label), ``kind`` a short name for programs, ``text`` what it means and what to do.
    """

    severity: str
    kind: str
    text: str

    def __str__(self) -> str:
        return f"{self.severity}: {self.text}"


class OccupancyGrid:
    """A map: free, occupied and unknown cells, and where they are.

    Parameters
    ----------
    array : array_like, shape (H, W)
        What is known of every cell; row 0 is the *top* of the map, as in a picture. Signed integers are those of
        a ROS ``OccupancyGrid``: -1 unknown, else 0 (free) to 100 (occupied). Floats are probabilities of being
        occupied from 0 to 1, NaN unknown. Any memory order and strides. Other types could mean one thing or its
        opposite and are refused; for gray values there is :meth:`from_image`.
    resolution : float
        Side of a cell in meters.
    origin : (float, float, float) or (float, float)
        x and y in meters and yaw in radians of the *lower left corner* of the array in the map frame.
    name : str
        What results call the map.
    occupied_thresh, free_thresh : float
        A cell is free up to ``free_thresh`` and occupied from ``occupied_thresh`` on, as probabilities; unknown
        between them.

    Raises
    ------
    MapError
        If the array has no cell, or a value outside of its range.
    TypeError
        If the array has another type or number of dimensions.

    Examples
    --------
    >>> import numpy as np
    >>> import placegraph as pg
    >>> m = pg.OccupancyGrid(np.zeros((20, 30), np.int8), resolution=0.05, origin=(-1.0, 2.0, 0.0))
    >>> m
    OccupancyGrid('map', 20 x 30 cells of 0.05 m, origin (-1.0, 2.0, 0.0))
    """

    __slots__ = ("_handle",)
    _handle: _native.Grid

    def __init__(
        self,
        array: ArrayLike,
        *,
        resolution: float,
        origin: tuple[float, ...] = (0.0, 0.0, 0.0),
        name: str = "map",
        occupied_thresh: float = 0.65,
        free_thresh: float = 0.196,
    ) -> None:
        thresholds = (float(occupied_thresh), float(free_thresh))
        values = _occupancies(_array2(array), *thresholds)
        self._handle = _native.Grid.from_occupancy(values, _frame(resolution, origin), thresholds, name)

    @classmethod
    def from_image(
        cls,
        gray: ArrayLike,
        *,
        resolution: float,
        origin: tuple[float, ...] = (0.0, 0.0, 0.0),
        name: str = "map",
        occupied_thresh: float = 0.65,
        free_thresh: float = 0.196,
        negate: bool = False,
        gray_205: Literal["unknown", "as-file"] = "unknown",
    ) -> OccupancyGrid:
        """The map of an array of gray values, (H, W) uint8, read as map_server reads an image.

        White is free and black occupied, unless ``negate``; 205 is what map savers write for unknown.
        """
        values = _array2(gray)
        if values.dtype != np.uint8:
            raise TypeError(f"expected gray values of type uint8, found {values.dtype}")
        thresholds = (float(occupied_thresh), float(free_thresh))
        frame = _frame(resolution, origin)
        as_file = _one_of("gray_205", gray_205, ("unknown", "as-file")) == "as-file"
        return cls._of(_native.Grid.from_gray(values, frame, thresholds, name, negate, as_file))

    @classmethod
    def _of(cls, native: _native.Grid) -> OccupancyGrid:
        self = cls.__new__(cls)
        self._handle = native
        return self

    @property
    def name(self) -> str:
        """What results call the map."""
        return self._handle.name

    @property
    def hash(self) -> str:
        """SHA-256 of the map's files or cells, in hexadecimal."""
        return self._handle.hash

    @property
    def resolution(self) -> float:
        """Side of a cell in meters."""
        return self._handle.resolution

    @property
    def origin(self) -> tuple[float, float, float]:
        """x and y in meters and yaw in radians of the lower left corner in the map frame."""
        return self._handle.origin

    @property
    def shape(self) -> tuple[int, int]:
        """Number of rows and columns (H, W)."""
        return self._handle.shape

    @property
    def array(self) -> NDArray[np.int8]:
        """(H, W) int8, a new array: 0 free, 100 occupied, -1 unknown; row 0 is the top."""
        return self._handle.array()

    def findings(self) -> list[Finding]:
        """What would spoil a labeling of the map, worst first."""
        return [Finding(*finding) for finding in self._handle.findings()]

    def scan(self, x: float, y: float, *, model: Model | None = None) -> NDArray[np.float64]:
        """(360,) ranges in meters of a laser scan from the center of the free cell at (x, y) in the map frame.

        Beam k looks along k degrees, counter-clockwise from the grid's x axis. ``model`` is whose scan is simulated: the
        default model's passes small obstacles that stand free; without a model every obstacle is seen.
        """
        return self._handle.scan(x, y, None if model is None else model._handle)

    def cell_at(self, x: float, y: float) -> tuple[int, int] | None:
        """(row, column) of the cell at (x, y) in meters of the map frame, row 0 at the top; ``None`` outside."""
        return self._handle.cell_at(x, y)

    def __repr__(self) -> str:
        height, width = self.shape
        return f"OccupancyGrid({self.name!r}, {height} x {width} cells of {self.resolution:g} m, origin {self.origin})"

    def __reduce__(self) -> tuple[Any, ...]:
        fields = {"resolution": self.resolution, "origin": self.origin, "name": self.name}
        return (_unpickled, (self.array, fields))


def _unpickled(array: NDArray[np.int8], fields: dict[str, Any]) -> OccupancyGrid:
    return OccupancyGrid(array, **fields)


def load_map(
    path: Path,
    *,
    resolution: float | None = None,
    rules: Literal["jazzy", "humble", "ros1"] = "jazzy",
    gray_205: Literal["unknown", "as-file"] = "unknown",
    allow_outside: bool = False,
    max_cells: int = 400_000_000,
) -> OccupancyGrid:
    """Reads a map: map_server YAML, a plain image (with ``resolution``), or any other map file that the program reads.

    Parameters
    ----------
    path : path
        The file.
    resolution : float, optional
        Meters per pixel: needed for an image alone; else it replaces what the file says.
    rules : {"jazzy", "humble", "ros1"}
        Whose map_server is followed where they differ.
    gray_205 : {"unknown", "as-file"}
        What gray 205 is where the file's thresholds turn unexplored space free.
    allow_outside : bool
        Whether a YAML file may name an image outside of its own folder.
    max_cells : int
        Larger maps are refused before memory is taken for them.

    Raises
    ------
    MapError
        If the file is no map.
    FileError
        If the system does not give the file; an ``OSError``, and a ``FileNotFoundError`` where it does not exist.
    """
    as_file = _one_of("gray_205", gray_205, ("unknown", "as-file")) == "as-file"
    return OccupancyGrid._of(
        _native.Grid.load(os.fspath(path), resolution, rules, as_file, allow_outside, max_cells)
    )


def as_map(map: OccupancyGrid | Path) -> OccupancyGrid:
    """``map`` itself, or the map in that file."""
    return map if isinstance(map, OccupancyGrid) else load_map(map)


def _array2(array: ArrayLike) -> NDArray[Any]:
    values = np.asarray(array)
    if values.ndim != 2:
        raise TypeError(f"expected an array of 2 dimensions (rows, columns), found {values.ndim}")
    return values.astype(values.dtype.newbyteorder("="), copy=False)


def _occupancies(values: NDArray[Any], occupied_thresh: float, free_thresh: float) -> NDArray[np.int8]:
    """Occupancies -1, 0 to 100 of an array of a type whose meaning is certain."""
    kind = values.dtype.kind
    if kind == "i":
        if values.size and (values.min() < -1 or values.max() > 100):
            raise MapError(
                f"expected occupancies of -1 (unknown) or 0 to 100, found {values.min()} to {values.max()}"
            )
        return values.astype(np.int8, copy=False)
    if kind == "f":
        known = ~np.isnan(values)
        outside = known & ~((values >= 0) & (values <= 1))
        if outside.any():
            raise MapError(f"expected probabilities of 0 to 1, or NaN for unknown, found {values[outside][0]}")
        states = np.full(values.shape, -1, np.int8)
        states[known & (values >= occupied_thresh)] = 100
        states[known & (values <= free_thresh)] = 0
        return states
    hint = {
        "u": "for gray values of a picture use OccupancyGrid.from_image, for occupancies array.astype(numpy.int8)",
        "b": "numpy.where(free, 0, 100).astype(numpy.int8) makes one of a mask of free cells",
    }.get(kind, "other types have no meaning as occupancies")
    raise TypeError(
        f"expected signed integers (-1 unknown, 0 to 100) or floats (0 to 1, NaN unknown), "
        f"found {values.dtype}: {hint}"
    )


def _frame(resolution: float, origin: tuple[float, ...]) -> tuple[float, tuple[float, float, float]]:
    numbers = tuple(float(number) for number in origin)
    if len(numbers) == 2:
        numbers += (0.0,)
    if len(numbers) != 3:
        raise MapError(f"expected an origin of (x, y, yaw) or (x, y), found {len(numbers)} numbers")
    return float(resolution), numbers


def _one_of(name: str, value: str, known: tuple[str, ...]) -> str:
    if value not in known:
        raise ValueError(f"expected {name} to be one of {', '.join(known)}, found {value!r}")
    return value
