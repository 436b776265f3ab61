"""Arrays in every memory order and type: right, or a clear error."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

import placegraph as pg

STATES = np.array([[-1, 0, 100], [0, 0, 100]], dtype=np.int8)


def grid(array: object, **kwargs: object) -> pg.OccupancyGrid:
    return pg.OccupancyGrid(array, resolution=0.05, **kwargs)  # type: ignore[arg-type]


def test_what_goes_in_comes_out_with_row_0_at_the_top() -> None:
    m = grid(STATES, origin=(1.0, 2.0, 0.0))
    assert m.array.dtype == np.int8 and m.array.flags.c_contiguous
    np.testing.assert_array_equal(m.array, STATES)
    assert (m.shape, m.resolution, m.origin, m.name) == ((2, 3), 0.05, (1.0, 2.0, 0.0), "map")
    # The lower left corner of the map is that of the last row.
    assert m.cell_at(1.01, 2.01) == (1, 0)
    assert m.cell_at(1.06, 2.06) == (0, 1)
    assert m.cell_at(0.99, 2.01) is None


def variants() -> dict[str, np.ndarray]:
    big = np.full((4, 6), 50, np.int8)
    big[::2, ::2] = STATES
    pages = np.zeros((2, 3, 5), np.int8)
    pages[:, :, 3] = STATES
    frozen = STATES.copy()
    frozen.flags.writeable = False
    misaligned = np.zeros(STATES.size * 8 + 1, np.uint8)[1:].view(np.int64).reshape(2, 3)
    misaligned[:] = STATES
    return {
        "C order": STATES,
        "Fortran order": np.asfortranarray(STATES),
        "transposed": STATES.T.copy().T,
        "every second": big[::2, ::2],
        "reversed": STATES[::-1, ::-1].copy()[::-1, ::-1],
        "a page": pages[:, :, 3],
        "read-only": frozen,
        "int16": STATES.astype(np.int16),
        "int32": STATES.astype(np.int32),
        "int64 not aligned": misaligned,
        "big endian": STATES.astype(">i4"),
        "list": STATES.tolist(),  # type: ignore[dict-item]
        "float64": np.array([[np.nan, 0, 1], [0.1, 0.196, 0.65]]),
        "float32": np.array([[np.nan, 0, 1], [0.1, 0.15, 0.7]], np.float32),
        "float16 big endian": np.array([[np.nan, 0, 1], [0.1, 0.15, 0.7]], ">f2"),
    }


@pytest.mark.parametrize("name", variants())
def test_any_memory_order_and_type_gives_the_same_map(name: str) -> None:
    np.testing.assert_array_equal(grid(variants()[name]).array, STATES)


def test_broadcast_views_and_masks_are_read() -> None:
    np.testing.assert_array_equal(grid(np.broadcast_to(np.int8(0), (3, 4))).array, np.zeros((3, 4)))


def test_values_between_the_thresholds_are_unknown() -> None:
    m = grid(np.array([[0, 19, 20, 64, 65, 100, -1]], np.int8))
    assert m.array.tolist() == [[0, 0, -1, -1, 100, 100, -1]]
    m = grid(np.array([[0.3, 0.5]]), free_thresh=0.4, occupied_thresh=0.5)
    assert m.array.tolist() == [[0, 100]]


@pytest.mark.parametrize(
    ("array", "error", "text"),
    [
        (np.zeros((2, 2), np.uint8), TypeError, "found uint8: for gray values of a picture use OccupancyGrid.from_image"),
        (np.zeros((2, 2), bool), TypeError, "found bool: numpy.where"),
        (np.zeros((2, 2), complex), TypeError, "found complex128"),
        (np.array([["a", "b"]]), TypeError, "found <U1"),
        (np.array([[None, 1]]), TypeError, "found object"),
        (np.zeros(4, np.int8), TypeError, "2 dimensions"),
        (np.zeros((2, 2, 3), np.int8), TypeError, "2 dimensions"),
        (np.int8(0), TypeError, "2 dimensions"),
        (np.zeros((0, 4), np.int8), pg.MapError, "at least one cell, found 4 x 0"),
        (np.array([[0, 101]], np.int16), pg.MapError, "found 0 to 101"),
        (np.array([[-2, 0]], np.int8), pg.MapError, "found -2 to 0"),
        (np.array([[0, 300]], np.int64), pg.MapError, "found 0 to 300"),
        (np.array([[0.5, 1.5]]), pg.MapError, "found 1.5"),
        (np.array([[-0.1]]), pg.MapError, "found -0.1"),
        (np.array([[np.inf]]), pg.MapError, "found inf"),
    ],
)
def test_what_is_no_map_is_refused(array: object, error: type[Exception], text: str) -> None:
    with pytest.raises(error, match=text):
        grid(array)


@pytest.mark.parametrize("resolution", [0.0, -1.0, float("nan"), float("inf")])
def test_a_resolution_is_above_0(resolution: float) -> None:
    with pytest.raises(pg.MapError, match="expected a resolution above 0"):
        pg.OccupancyGrid(STATES, resolution=resolution)


def test_an_origin_has_two_or_three_finite_numbers() -> None:
    assert grid(STATES, origin=(1, 2)).origin == (1.0, 2.0, 0.0)
    for origin in [(1,), (1, 2, 3, 4), ()]:
        with pytest.raises(pg.MapError, match="expected an origin"):
            grid(STATES, origin=origin)
    with pytest.raises(pg.MapError, match="origin"):
        grid(STATES, origin=(float("nan"), 0, 0))


def test_gray_values_are_read_as_map_server_reads_them() -> None:
    gray = np.array([[254, 205], [0, 255]], np.uint8)
    assert pg.OccupancyGrid.from_image(gray, resolution=0.05).array.tolist() == [[0, -1], [100, 0]]
    inverted = pg.OccupancyGrid.from_image(np.asfortranarray(255 - gray), resolution=0.05, negate=True)
    assert inverted.array.tolist() == [[0, -1], [100, 0]]
    with pytest.raises(TypeError, match="uint8, found int64"):
        pg.OccupancyGrid.from_image(gray.astype(np.int64), resolution=0.05)


def test_memory_order_does_not_change_a_label(office: pg.OccupancyGrid, result: pg.Result) -> None:
    fields = {"resolution": office.resolution, "origin": office.origin}
    for array in [np.asfortranarray(office.array), office.array[::-1].copy()[::-1], office.array.astype(np.int64)]:
        again = pg.label(pg.OccupancyGrid(array, **fields))  # type: ignore[arg-type]
        np.testing.assert_array_equal(again.labels, result.labels)
        np.testing.assert_array_equal(again.regions, result.regions)


def test_the_callers_array_is_neither_kept_nor_changed() -> None:
    array = np.zeros((5, 5), np.int8)
    m = grid(array)
    array[:] = 100
    assert (m.array == 0).all()
    m.array[:] = 100
    assert (m.array == 0).all()


def test_a_map_pickles() -> None:
    m = grid(STATES, origin=(1.0, 2.0, 0.5), name="site")
    again = pickle.loads(pickle.dumps(m))
    assert (again.hash, again.name, again.origin) == (m.hash, m.name, m.origin)
    np.testing.assert_array_equal(again.array, m.array)


def test_the_hash_is_that_of_all_that_is_known_of_a_map() -> None:
    hashes = [grid(STATES), grid(STATES[::-1]), grid(STATES, origin=(0, 1)), pg.OccupancyGrid(STATES, resolution=0.1)]
    assert len({m.hash for m in hashes}) == 4
    assert grid(STATES).hash == grid(np.asfortranarray(STATES), name="other").hash


def test_a_scan_has_360_ranges_in_meters() -> None:
    walls = np.full((23, 43), 100, np.int8)
    walls[1:-1, 1:-1] = 0
    m = pg.OccupancyGrid(walls, resolution=0.1, origin=(0.0, 0.0, 0.0))
    ranges = m.scan(2.15, 1.15)
    assert ranges.shape == (360,) and ranges.dtype == np.float64
    assert ranges[0] == pytest.approx(2.05) and ranges[90] == pytest.approx(1.05)
    with pytest.raises(ValueError, match="expected a free cell"):
        m.scan(0.05, 0.05)
    with pytest.raises(ValueError, match="inside the map"):
        m.scan(-1, 0)
