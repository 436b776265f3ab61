"""Answers, and the place of a robot that moves."""

from __future__ import annotations

import json

import numpy as np
import placegraph as pg

from placegraph_ros.places import CurrentPlace, describe


def test_a_point_in_a_doorway_names_both_sides(home_result: pg.Result) -> None:
    topology = home_result.topology
    doorway = next(each for each in topology.doorways if len(each.side_ids) == 2)
    answer = json.loads(json.dumps(describe(topology, *doorway.anchor, "map")))
    assert answer["is_inside"] and answer["frame_id"] == "map"
    assert answer["place"]["name"] == doorway.name
    assert answer["place"]["width_m"] == doorway.width_m
    assert [side["id"] for side in answer["place"]["sides"]] == list(doorway.side_ids)
    assert all(side["name"] in topology for side in answer["place"]["sides"])


def test_a_point_outside_has_the_nearest_place(home_result: pg.Result) -> None:
    answer = describe(home_result.topology, 1e4, 1e4, "map")
    assert not answer["is_inside"] and answer["border_m"] > 1e3
    assert answer["place"]["name"] in home_result.topology
    room = next(place for place in home_result.places if not isinstance(place, pg.Doorway))
    assert "sides" not in describe(home_result.topology, *room.anchor, "map")["place"]


def way_through_a_doorway(topology: pg.Topology) -> tuple[np.ndarray, pg.Doorway]:
    """Points a centimeter apart from one side of a doorway to the other."""
    doorway = next(each for each in topology.doorways if len(each.side_ids) == 2)
    line = topology.route(*doorway.side_ids).line
    steps = [np.linspace(a, b, max(2, int(np.hypot(*(b - a)) / 0.01))) for a, b in zip(line, line[1:])]
    return np.concatenate(steps), doorway


def test_a_robot_goes_through_a_doorway(home_result: pg.Result) -> None:
    topology = home_result.topology
    points, doorway = way_through_a_doorway(topology)
    current = CurrentPlace(0.3)
    seen = [place.id for place, is_other in (current.move_to(topology, *p) for p in points) if is_other]
    assert seen == [doorway.side_ids[0], doorway.id, doorway.side_ids[1]]


def test_standing_on_a_border_changes_nothing(home_result: pg.Result) -> None:
    """The same way with the noise of a localization: without the margin the place flickers, with it it does not."""
    topology = home_result.topology
    points, doorway = way_through_a_doorway(topology)
    random = np.random.default_rng(0)
    noisy = np.repeat(points, 3, axis=0) + random.normal(0, 0.03, (3 * len(points), 2))

    def changes(margin_m: float) -> list[int]:
        current = CurrentPlace(margin_m)
        moves = (current.move_to(topology, *point) for point in noisy)
        return [place.id for place, is_other in moves if is_other and place is not None]

    assert changes(0.3) == [doorway.side_ids[0], doorway.id, doorway.side_ids[1]]
    assert len(changes(0.0)) > 5


def just_inside(topology: pg.Topology, place: pg.Place) -> tuple[float, float]:
    """A point of a place that is nearly at its border."""
    anchor = np.array(place.anchor)
    for corner in place.outline[0].exterior:
        x, y = corner + 0.02 * (anchor - corner)
        location = topology.where(x, y)
        if location.place == place and location.is_inside and location.distance_m < place.clearance_m / 4:
            return x, y
    raise AssertionError("the place has no corner that can be seen from its anchor")


def test_a_place_that_vanished_is_left_at_once(home_result: pg.Result) -> None:
    topology = home_result.topology
    current = CurrentPlace(1e9)
    first = topology.places[0]
    assert current.move_to(topology, *first.anchor) == (first, True)
    edge = just_inside(topology, topology.places[1])
    assert current.move_to(topology, *edge) == (first, False), "the margin holds"
    document = topology.document | {
        "places": [p for p in topology.document["places"] if p["id"] != first.id],
        "connections": [c for c in topology.document["connections"] if first.id not in (c["a"], c["b"])],
    }
    document["places"] = [
        p | {"doorway": p["doorway"] | {"sides": [s for s in p["doorway"]["sides"] if s != first.id]}}
        if p.get("doorway")
        else p
        for p in document["places"]
    ]
    document.pop("sha256", None)
    left = pg.Topology(json.dumps(document))
    place, is_other = current.move_to(left, *just_inside(left, left.places[0]))
    assert (place, is_other) == (left.places[0], True)
    assert current.move_to(left, 1e6, 1e6) == (left.places[0], False), "outside of the map nothing is entered"
