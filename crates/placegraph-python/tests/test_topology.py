"""The topological map as objects, and in other libraries."""

from __future__ import annotations

import json
import pickle
from pathlib import Path

import numpy as np
import pytest

import placegraph as pg


@pytest.fixture(scope="module")
def topology(result: pg.Result) -> pg.Topology:
    return result.topology


def test_the_text_is_kept_and_read_again(topology: pg.Topology, tmp_path: Path) -> None:
    text = topology.to_json()
    assert pg.Topology(text).to_json() == text
    (tmp_path / "topology.json").write_text(text)
    assert pg.Topology.load(tmp_path / "topology.json").places == topology.places
    assert pickle.loads(pickle.dumps(topology)).to_json() == text
    assert json.loads(text) == topology.document


def test_places_are_found_by_name_and_number(topology: pg.Topology) -> None:
    room = topology["room 1"]
    assert topology[room.id] is room and topology.place(str(room.id)) is room and topology.place(room) is room
    assert "room 1" in topology and room in topology and "attic" not in topology
    assert len(topology) == len(list(topology)) == len(topology.places)
    with pytest.raises(pg.TopologyError, match="expected the name or the number of a place, found 'attic'"):
        topology["attic"]


def test_doorways_are_places_with_a_width_and_sides(topology: pg.Topology) -> None:
    assert topology.doorways == tuple(p for p in topology.places if p.role == "doorway")
    for doorway in topology.doorways:
        first, second = map(np.array, doorway.jambs)
        assert np.hypot(*(first - second)) == pytest.approx(doorway.width_m, abs=0.11)
        assert all(topology[side].role != "doorway" for side in doorway.side_ids)


def test_where_agrees_with_the_program(topology: pg.Topology, program, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    (tmp_path / "topology.json").write_text(topology.to_json())
    for x, y in [(-14.0, 1.0), (-18.4, 2.6), (100.0, 100.0), (-22.0, -0.6)]:
        said = json.loads(program("where", tmp_path / "topology.json", "--at", f"{x},{y}", "--json").stdout)
        found = topology.where(x, y)
        assert found is not None
        assert (found.is_inside, found.place.id) == (said["inside"], said["place"]["id"])
        assert found.distance_m == said["border_m" if found.is_inside else "distance_m"]


def test_routes_agree_with_the_program(topology: pg.Topology, program, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    (tmp_path / "topology.json").write_text(topology.to_json())
    way = topology.route("room 1", "corridor 3") if "corridor 3" in topology else topology.route(1, 4)
    first, last = way.places[0], way.places[-1]
    said = json.loads(program("route", tmp_path / "topology.json", first.name, last.name, "--json").stdout)
    assert [place.id for place in way.places] == [place["id"] for place in said["places"]]
    assert way.length_m == said["length_m"] and len(way.line) == len(said["line"])
    assert way.length_m == pytest.approx(np.hypot(*np.diff(way.line, axis=0).T).sum())
    assert str(way).startswith(first.name + " → ")
    there_and_back = topology.route(last, first)
    assert there_and_back.places == way.places[::-1]


def test_without_a_way_there_is_an_error() -> None:
    two = np.full((60, 200), 100, np.int8)
    two[5:55, 5:90] = 0
    two[5:55, 110:195] = 0
    topology = pg.label(pg.OccupancyGrid(two, resolution=0.1)).topology
    assert len(topology) == 2
    with pytest.raises(pg.NoRouteError, match="there is no route from"):
        topology.route(1, 2)


def test_networkx_has_the_attributes_of_graphml(result: pg.Result, tmp_path: Path) -> None:
    networkx = pytest.importorskip("networkx")
    ours = result.topology.to_networkx()
    (path,) = result.export("graphml", tmp_path / "graph.graphml")
    theirs = networkx.read_graphml(path, node_type=int)
    assert ours.graph.keys() <= theirs.graph.keys() | {"node_default", "edge_default"}
    assert set(ours.nodes) == set(theirs.nodes)
    assert set(map(frozenset, ours.edges)) == set(map(frozenset, theirs.edges))
    pairs = [(ours.nodes[node], theirs.nodes[node]) for node in ours]
    pairs += [(data, theirs.edges[a, b]) for a, b, data in ours.edges(data=True)]
    for mine, other in pairs:
        assert mine.keys() == other.keys() - {"id"}
        assert all(mine[name] == pytest.approx(other[name]) for name in mine if not isinstance(mine[name], str))
        assert all(mine[name] == other[name] for name in mine if isinstance(mine[name], str))


def test_geopandas_has_the_areas_of_the_places(topology: pg.Topology) -> None:
    pytest.importorskip("geopandas")
    frame = topology.to_geopandas()
    assert frame.crs.to_epsg() == 3857 and frame.index.name == "id"
    assert frame.geometry.is_valid.all()
    np.testing.assert_allclose(frame.geometry.area, frame["area_m2"], rtol=1e-9)
    assert frame.geometry.exterior.is_ccw.all() if (frame.geom_type == "Polygon").all() else True
    assert list(topology.to_pandas()["name"]) == [place.name for place in topology.places]


def test_a_broken_document_is_refused(topology: pg.Topology) -> None:
    document = json.loads(topology.to_json())
    document["places"][0]["id"] = 10**6
    for text in ["", "{}", "[]", "nonsense", json.dumps(document)]:
        with pytest.raises(pg.TopologyError):
            pg.Topology(text)
