"""Maps one after the other."""

from __future__ import annotations

import dataclasses
import queue
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import placegraph as pg
import pytest
from conftest import map_message, occupancy_message

from placegraph_ros.grids import GridData, read_grid
from placegraph_ros.labeler import NO_GRAPH, Labeler, Output
from placegraph_ros.settings import Settings

Start = Callable[..., tuple[Labeler, "queue.Queue[Output | str]"]]


@pytest.fixture
def start() -> Iterator[Start]:
    started: list[Labeler] = []

    def run(**values: object) -> tuple[Labeler, queue.Queue[Output | str]]:
        found: queue.Queue[Output | str] = queue.Queue()
        settings = dataclasses.replace(Settings(min_interval_s=0.0), **values)  # type: ignore[arg-type]
        started.append(Labeler(settings, found.put, found.put))
        return started[-1], found

    yield run
    for labeler in started:
        labeler.close()


def next_output(found: queue.Queue[Output | str]) -> Output:
    output = found.get(timeout=300)
    assert isinstance(output, Output), output
    return output


def unknown_where_zero(labels: np.ndarray) -> np.ndarray:
    return np.where(labels == 0, -1, labels.astype(int))


def small(n_rooms: int, frame_id: str = "map", yaw: float = 0.0) -> GridData:
    """Rooms of 3 x 2.5 m in a row, each with a door to the next one."""
    cells = np.full((60, 5 + 65 * n_rooms), 100, np.int8)
    for k in range(n_rooms):
        cells[5:55, 5 + 65 * k : 65 + 65 * k] = 0
        if k > 0:
            cells[20:38, 65 * k : 5 + 65 * k] = 0
    return read_grid(occupancy_message(cells, origin=(-1.0, 2.0, yaw), frame_id=frame_id))


def test_the_result_is_that_of_the_package(start: Start, home: pg.OccupancyGrid, home_result: pg.Result) -> None:
    labeler, found = start()
    assert labeler.submit(read_grid(map_message(home)))
    output = next_output(found)
    np.testing.assert_array_equal(output.result.labels, home_result.labels)
    assert output.labels is not None and output.regions is not None and output.region_image is not None
    np.testing.assert_array_equal(output.labels.cells[::-1], unknown_where_zero(home_result.labels))
    np.testing.assert_array_equal(output.region_image, home_result.regions)
    assert output.remarks == ()
    keepout, speed = output.masks["keepout"], output.masks["speed"]
    assert (keepout.kind, keepout.base, keepout.multiplier) == (0, 0, 1)
    assert (speed.kind, speed.base, speed.multiplier) == (1, 0, 1)
    closed = keepout.grid.cells[::-1] == 100
    assert closed[home_result.regions == 0].all() and not closed[home_result.labels == 3].any()
    np.testing.assert_array_equal(speed.grid.cells[::-1] == 50, home_result.labels == 3)
    assert keepout.grid.origin == pytest.approx(home.origin, abs=1e-9)


def test_numbers_stay_while_the_map_grows(start: Start) -> None:
    labeler, found = start()
    labeler.submit(small(2))
    before = next_output(found).result.topology
    labeler.submit(small(3))
    after = next_output(found).result.topology
    assert len(after) > len(before)
    for place in before:
        assert after.where(*place.anchor).place.id == place.id, place


def test_the_newest_map_comes_next_and_the_same_map_is_left_out(start: Start) -> None:
    labeler, found = start(min_interval_s=0.5)
    assert labeler.submit(small(1))
    first = next_output(found)
    for n_rooms in (2, 3, 4):
        assert labeler.submit(small(n_rooms))
    assert next_output(found).grid.is_same_map(small(4))
    assert not labeler.submit(small(4)), "nothing changed"
    assert found.empty() and first.grid.is_same_map(small(1))


def test_frozen_takes_the_first_good_map(start: Start) -> None:
    labeler, found = start(follow="frozen")
    nothing = read_grid(occupancy_message(np.full((20, 20), -1)))
    assert labeler.submit(nothing)
    assert isinstance(found.get(timeout=300), str)
    assert labeler.submit(small(1))
    next_output(found)
    assert not labeler.submit(small(2))
    labeler.change(Settings(follow="live", min_interval_s=0.0))
    assert labeler.submit(small(2))
    assert next_output(found).grid.is_same_map(small(2))


def test_bad_maps_are_told_and_the_next_one_is_labeled(start: Start) -> None:
    labeler, found = start()
    for cells in (np.full((20, 20), 100), np.full((20, 20), 101)):
        labeler.submit(read_grid(occupancy_message(cells)))
        assert isinstance(found.get(timeout=300), str)
    labeler.submit(small(1))
    next_output(found)


def test_settings_label_the_map_again(start: Start, tmp_path: Path) -> None:
    labeler, found = start()
    labeler.submit(small(2))
    place = next(p for p in next_output(found).result.places if not isinstance(p, pg.Doorway))
    edits = tmp_path / "edits.toml"
    edits.write_text(f'[[edit]]\naction = "rename"\nat = [{place.anchor[0]}, {place.anchor[1]}]\nname = "den"\n')
    labeler.change(Settings(min_interval_s=0.0, edits=str(edits)))
    assert next_output(found).result.topology["den"].id == place.id
    labeler.change(Settings(min_interval_s=0.0, edits=str(edits), exports=()))
    with pytest.raises(queue.Empty):
        found.get(timeout=0.5)
    with pytest.raises(pg.ModelError):
        labeler.change(Settings(model=str(edits)))


def test_what_a_map_cannot_have_is_said(start: Start) -> None:
    labeler, found = start()
    labeler.submit(small(1, yaw=0.5))
    output = next_output(found)
    assert output.masks == {} and output.route_graph == NO_GRAPH
    assert any("is rotated" in remark for remark in output.remarks)
    assert any("rout" in remark for remark in output.remarks)
    assert output.labels is not None and output.labels.origin[2] == 0.5


def test_another_frame_starts_anew(start: Start, tmp_path: Path) -> None:
    labeler, found = start()
    labeler.submit(small(2))
    next_output(found)
    labeler.submit(small(2, frame_id="other"))
    output = next_output(found)
    assert output.labels is not None and output.labels.frame_id == "other"
    assert output.result.changes == ()


def test_topics_that_nobody_wants_are_not_made(start: Start) -> None:
    labeler, found = start(topics=("markers",))
    labeler.submit(small(1))
    output = next_output(found)
    assert (output.labels, output.regions, output.region_image, output.route_graph) == (None, None, None, None)
    assert output.masks == {}
