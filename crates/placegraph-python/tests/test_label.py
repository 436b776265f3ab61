"""Labels of a map: their shapes, and what is said of them."""

from __future__ import annotations

import pickle
import re
from pathlib import Path

import numpy as np
import pytest

import placegraph as pg


def test_labels_regions_and_probabilities_agree(office: pg.OccupancyGrid, result: pg.Result) -> None:
    free = office.array == 0
    h, w = office.shape
    assert (result.labels.dtype, result.labels.shape) == (np.uint8, (h, w))
    assert (result.regions.dtype, result.regions.shape) == (np.uint32, (h, w))
    assert (result.probabilities.dtype, result.probabilities.shape) == (np.float32, (3, h, w))
    assert ((result.labels > 0) == free).all() and set(np.unique(result.labels)) == {0, 1, 2, 3}
    np.testing.assert_allclose(result.probabilities.sum(axis=0)[free], 1, atol=1e-5)
    assert (result.probabilities[:, ~free] == 0).all()
    assert (result.regions[~free] == 0).all()
    assert set(np.unique(result.regions)) == {0, *(place.id for place in result.places)}
    for place in result.places:
        cells = result.regions == place.id
        assert cells.sum() == place.n_cells
        assert {result.classes[k - 1].name for k in np.unique(result.labels[cells])} == {place.class_name}
        assert place.area_m2 == pytest.approx(place.n_cells * office.resolution**2)


def test_places_lie_where_their_cells_are(office: pg.OccupancyGrid, result: pg.Result) -> None:
    for place in result.places:
        assert result.regions[office.cell_at(*place.anchor)] == place.id
        location = result.topology.where(*place.anchor)
        assert location is not None and location.is_inside and location.place is place


def test_arrays_are_read_only_and_made_once(result: pg.Result) -> None:
    assert result.labels is result.labels
    with pytest.raises(ValueError, match="read-only"):
        result.labels[0, 0] = 1


def test_the_chapters_path_and_stages_are_there(office: pg.OccupancyGrid, result: pg.Result) -> None:
    plain = pg.label(office, doorways=False, correction=False)
    assert (plain.labels != result.labels).any()
    free = office.array == 0
    np.testing.assert_array_equal(plain.labels[free], plain.probabilities.argmax(axis=0)[free] + 1)
    np.testing.assert_array_equal(plain.classified, result.classified)


def test_names_are_carried_over_and_changes_told(office: pg.OccupancyGrid, result: pg.Result, tmp_path: Path) -> None:
    edits = tmp_path / "edits.toml"
    room = next(place for place in result.places if place.class_name == "room")
    edits.write_text(f'[[edit]]\naction = "rename"\nat = [{room.anchor[0]}, {room.anchor[1]}]\nname = "kitchen"\n')
    named = pg.label(office, edits=edits)
    assert named.topology["kitchen"].anchor == room.anchor
    array = office.array
    array[: office.shape[0] // 2] = -1
    half = pg.OccupancyGrid(array, resolution=office.resolution, origin=office.origin)
    again = pg.label(half, previous=named)
    assert "kitchen" in again.topology
    assert any(change["change"] == "vanished" for change in again.changes)
    assert named.changes == ()
    saved = tmp_path / "topology.json"
    saved.write_text(named.topology.to_json())
    assert pg.label(half, previous=saved).topology.to_json() == again.topology.to_json()


def test_edits_that_do_not_apply_are_told(office: pg.OccupancyGrid, tmp_path: Path) -> None:
    edits = tmp_path / "edits.toml"
    edits.write_text('[[edit]]\naction = "rename"\nat = [1000.0, 0.0]\nname = "nowhere"\n')
    assert any("edit 1 of" in finding for finding in pg.label(office, edits=edits).findings)


def test_routes_are_for_a_robot_with_a_size(office: pg.OccupancyGrid) -> None:
    wide = pg.label(office, robot_radius=0.8, robot_at=(-18.4, 2.6))
    assert any(connection.length_m is None for connection in wide.connections)
    assert any(place.is_cut_off for place in wide.places)
    assert not wide.topology.where(-18.4, 2.6).place.is_cut_off  # type: ignore[union-attr]
    ways = [connection for connection in wide.connections if connection.line is not None]
    assert ways and all(way.clearance_m is not None and way.clearance_m >= 0.8 - 1e-3 for way in ways)
    for radius in (-1.0, 11.0, float("nan")):
        with pytest.raises(ValueError, match="a robot's radius of 0 to 10 m"):
            pg.label(office, robot_radius=radius)


def test_results_print_well(result: pg.Result) -> None:
    assert re.fullmatch(r"Result\('office': 1 corridor, 1\d room, \d+ doorway; \d+ connections\)", repr(result))
    assert repr(result.topology["room 1"]).startswith("<'room 1': room, 28.4 m² at (")
    assert repr(result.doorways[0]).startswith(f"<{result.doorways[0].name!r}: doorway, ")
    assert " m wide at (" in repr(result.doorways[0])
    assert repr(result.connections[0]).startswith("<'")


def test_a_notebook_shows_the_overview(result: pg.Result) -> None:
    assert result._repr_png_().startswith(b"\x89PNG")
    html = result._repr_html_()
    assert "data:image/png;base64," in html and html.count("<tr>") == len(result.places) + 1


def test_names_are_escaped_in_a_page(office: pg.OccupancyGrid, result: pg.Result, tmp_path: Path) -> None:
    x, y = result.places[0].anchor
    edits = tmp_path / "edits.toml"
    edits.write_text(f'[[edit]]\naction = "rename"\nat = [{x}, {y}]\nname = "<script>&"\n')
    html = pg.label(office, edits=edits)._repr_html_()
    assert "<script>" not in html and "&lt;script&gt;&amp;" in html


def test_a_model_pickles_and_saves_as_its_file(tmp_path: Path) -> None:
    model = pg.default_model()
    again = pickle.loads(pickle.dumps(model))
    assert (again, again.name, again.hash) == (model, "default", model.hash)
    model.save(tmp_path / "copy.json")
    loaded = pg.load_model(tmp_path / "copy.json")
    assert loaded == model and loaded.name == "copy.json"
    assert [each.name for each in model.classes] == ["corridor", "room", "doorway"]
    assert [each.role for each in model.classes] == ["passage", "place", "doorway"]


def test_a_map_without_free_cells_has_no_places() -> None:
    empty = pg.label(pg.OccupancyGrid([[100, -1]], resolution=0.05))
    assert empty.places == () and empty.topology.where(0, 0) is None
    assert empty.labels.tolist() == [[0, 0]]
    assert empty.topology.to_pandas().shape[0] == 0 if _has_pandas() else True


def _has_pandas() -> bool:
    try:
        import pandas  # noqa: F401
    except ImportError:
        return False
    return True


def test_a_plot_shows_map_and_names_in_meters(result: pg.Result) -> None:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, ax = plt.subplots()
    assert result.plot(ax=ax) is ax
    figure.canvas.draw()
    assert {text.get_text() for text in ax.texts} == {p.name for p in result.places if p.role != "doorway"}
    x, y = result.places[0].anchor
    (x0, x1), (y0, y1) = ax.get_xlim(), ax.get_ylim()
    assert x0 < x < x1 and y0 < y < y1
    plt.close(figure)
