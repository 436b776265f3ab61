"""Maps that grow."""

from __future__ import annotations

import numpy as np
import pytest

import placegraph as pg


def growing(home: pg.OccupancyGrid) -> list[pg.OccupancyGrid]:
    """A map of which more and more is known, from the left."""
    array = home.array
    maps = []
    for share in (0.4, 0.6, 0.8, 1.0):
        known = array.copy()
        known[:, int(share * array.shape[1]) :] = -1
        maps.append(pg.OccupancyGrid(known, resolution=home.resolution, origin=home.origin))
    return maps


def test_a_session_gives_what_label_gives() -> None:
    maps = growing(pg.load_map("maps/home/map.yaml"))
    session, previous = pg.Session(), None
    for map in maps:
        found = session.update(map)
        alone = pg.label(map, previous=previous, hold=True)
        np.testing.assert_array_equal(found.labels, alone.labels)
        np.testing.assert_array_equal(found.regions, alone.regions)
        np.testing.assert_array_equal(found.probabilities, alone.probabilities)
        assert found.topology.to_json() == alone.topology.to_json()
        assert found.changes == alone.changes
        previous = alone


def test_hold_is_named_where_there_is_something_to_hold_on_to() -> None:
    home = pg.load_map("maps/home/map.yaml")
    first = pg.label(home, hold=True)
    options = lambda result: result.topology.document["program"].get("options", [])
    assert "--hold" not in options(first)
    assert "--hold" in options(pg.label(home, previous=first, hold=True))
    with pytest.raises(ValueError, match="align or hold"):
        pg.label(home, previous=first, hold=True, align=True)
    session = pg.Session()
    session.update(home)
    assert "--hold" not in options(session.update(home, hold=False))


def test_an_earlier_result_and_edits_are_followed(tmp_path) -> None:  # type: ignore[no-untyped-def]
    home = pg.load_map("maps/home/map.yaml")
    first = pg.label(home)
    x, y = first.places[0].anchor
    edits = tmp_path / "edits.toml"
    edits.write_text(f'[[edit]]\naction = "rename"\nat = [{x}, {y}]\nname = "den"\n')
    result = pg.Session().update(home, previous=first, edits=edits)
    assert result.topology["den"].id == first.places[0].id
    session = pg.Session()
    with pytest.raises(pg.EditError):
        (tmp_path / "broken.toml").write_text("[[")
        session.update(home, edits=tmp_path / "broken.toml")
    assert session.update(home).topology.places == first.topology.places
