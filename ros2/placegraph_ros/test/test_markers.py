"""Markers of a topological map."""

from __future__ import annotations

import placegraph as pg

from placegraph_ros.markers import Action, Kind, Marker, markers

COLORS = {"corridor": (1.0, 0.5, 0.0), "room": (0.0, 0.5, 1.0), "doorway": (1.0, 0.0, 0.0)}


def of(found: list[Marker], namespace: str) -> dict[int, Marker]:
    return {each.id: each for each in found if each.namespace == namespace}


def test_everything_is_there_once(home_result: pg.Result) -> None:
    topology = home_result.topology
    found = markers(topology, COLORS)
    assert found[0].action == Action.DELETE_ALL
    assert all(each.action == Action.ADD for each in found[1:])
    names = [(each.namespace, each.id) for each in found[1:]]
    assert len(names) == len(set(names))
    assert set(of(found, "outlines")) == {place.id for place in topology}
    assert set(of(found, "doors")) == {doorway.id for doorway in topology.doorways}
    assert set(of(found, "names")) | set(of(found, "doors")) == {place.id for place in topology}


def test_what_a_marker_shows(home_result: pg.Result) -> None:
    topology = home_result.topology
    found = markers(topology, COLORS)
    room = next(place for place in topology if place.class_name == "room")
    name, outline = of(found, "names")[room.id], of(found, "outlines")[room.id]
    assert (name.kind, name.text, name.position[:2]) == (Kind.TEXT, room.name, room.anchor)
    assert name.scale[:2] == (0, 0) and 0.2 <= name.scale[2] <= 0.6
    n_corners = sum(len(ring) for part in room.outline for ring in (part.exterior, *part.holes))
    assert len(outline.points) == 2 * n_corners, "two ends for each side, the last one too"
    assert outline.points[-1] == outline.points[0] or len(room.outline[0].holes) > 0
    assert outline.color == COLORS["room"]
    graph = of(found, "graph")
    n_pieces = sum(len(c.line) - 1 for c in topology.connections if c.line is not None)
    assert len(graph[0].points) == 2 * n_pieces
    assert len(graph[1].points) == len(topology)
    door = next(iter(topology.doorways))
    assert [point[:2] for point in of(found, "doors")[door.id].points] == list(door.jambs)


def test_markers_need_no_class_of_ours(home_result: pg.Result) -> None:
    assert markers(home_result.topology, {})[1].color == (0, 0, 0)
