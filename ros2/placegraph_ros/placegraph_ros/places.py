"""Answers to "which place is this?"."""

from __future__ import annotations

from typing import Any

import placegraph as pg


def describe(topology: pg.Topology, x: float, y: float, frame_id: str) -> dict[str, Any]:
    """What is at the point (x, y) of the map frame: the members that ``~/place`` has, docs/ros2.md."""
    location = topology.where(x, y)
    answer: dict[str, Any] = {"frame_id": frame_id, "x": x, "y": y}
    if location is None:
        return {**answer, "is_inside": False, "place": None}
    border = {"is_inside": location.is_inside, "border_m": location.distance_m}
    return {**answer, **border, "place": describe_place(topology, location.place)}


def describe_place(topology: pg.Topology, place: pg.Place) -> dict[str, Any]:
    """Number, name, class and probability of a place; of a doorway also its width and what is on both sides."""
    facts: dict[str, Any] = {
        "id": place.id,
        "name": place.name,
        "class": place.class_name,
        "probability": place.probability,
    }
    if isinstance(place, pg.Doorway):
        sides = [topology[number] for number in place.side_ids]
        facts["width_m"] = place.width_m
        facts["sides"] = [{"id": side.id, "name": side.name, "class": side.class_name} for side in sides]
    return facts


class CurrentPlace:
    """The place that the robot is in, from one position after the other.

    Another place counts once the robot is ``margin_m`` inside of it (half of the place's clearance where it is narrow, as
    doorways are): a robot that stands on a border does not change its place with every step of its localization.
    """

    def __init__(self, margin_m: float) -> None:
        self.margin_m = margin_m
        self._id: int | None = None

    def move_to(self, topology: pg.Topology, x: float, y: float) -> tuple[pg.Place | None, bool]:
        """The place now, ``None`` before any was entered, and whether it is another one than before."""
        before = self._id
        known = before is not None and before in topology
        location = topology.where(x, y)
        if location is not None and location.is_inside and location.place.id != before:
            needed_m = min(self.margin_m, location.place.clearance_m / 2)
            if not known or location.distance_m >= needed_m:
                self._id = location.place.id
        elif not known:
            self._id = None
        place = None if self._id is None or self._id not in topology else topology[self._id]
        return place, self._id != before
