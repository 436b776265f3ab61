"""The topological map as markers for RViz, as plain data."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from enum import IntEnum

import placegraph as pg

Point = tuple[float, float, float]
Color = tuple[float, float, float]


class Kind(IntEnum):
    """Types of ``visualization_msgs/Marker`` that are used."""

    LINE_LIST = 5
    SPHERE_LIST = 7
    TEXT = 9


class Action(IntEnum):
    """Actions of ``visualization_msgs/Marker`` that are used."""

    ADD = 0
    DELETE_ALL = 3


# Heights in meters: lines above the map, names above lines.
_OUTLINE_Z, _GRAPH_Z, _DOOR_Z, _NAME_Z = 0.02, 0.04, 0.06, 0.10
_BLACK: Color = (0.0, 0.0, 0.0)
_DOOR: Color = (0.84, 0.37, 0.0)


@dataclass(frozen=True)
class Marker:
    """What is set of a ``visualization_msgs/Marker``; coordinates are meters of the map frame.

    ``namespace`` and ``id`` together name a marker: those of a place are its number, which lasts.
    """

    namespace: str = ""
    id: int = 0
    kind: Kind = Kind.LINE_LIST
    action: Action = Action.ADD
    scale: tuple[float, float, float] = (0.0, 0.0, 0.0)
    color: Color = _BLACK
    position: Point = (0.0, 0.0, 0.0)
    points: tuple[Point, ...] = field(default=())
    text: str = ""


def markers(topology: pg.Topology, colors: dict[str, Color]) -> list[Marker]:
    """Outlines, graph, doors and names; first of all one that deletes what was there before.

    ``colors`` has one for every class, from 0 to 1.
    """
    found = [Marker(action=Action.DELETE_ALL)]
    for place in topology.places:
        color = colors.get(place.class_name, _BLACK)
        rings = [ring for part in place.outline for ring in (part.exterior, *part.holes)]
        sides = [side for ring in rings for side in _sides(ring.tolist())]
        found.append(Marker("outlines", place.id, scale=(0.04, 0.0, 0.0), color=color, points=tuple(sides)))
    ways = [
        point
        for connection in topology.connections
        if connection.line is not None
        for point in _steps(connection.line.tolist(), _GRAPH_Z)
    ]
    stations = tuple((*place.anchor, _GRAPH_Z) for place in topology.places)
    found.append(Marker("graph", 0, scale=(0.05, 0.0, 0.0), points=tuple(ways)))
    found.append(Marker("graph", 1, Kind.SPHERE_LIST, scale=(0.2, 0.2, 0.2), points=stations))
    for place in topology.places:
        if isinstance(place, pg.Doorway):
            jambs = tuple((*jamb, _DOOR_Z) for jamb in place.jambs)
            found.append(Marker("doors", place.id, scale=(0.08, 0.0, 0.0), color=_DOOR, points=jambs))
        else:
            height_m = min(max(place.clearance_m / 2, 0.2), 0.6)
            position = (*place.anchor, _NAME_Z)
            scale = (0.0, 0.0, height_m)
            found.append(Marker("names", place.id, Kind.TEXT, scale=scale, position=position, text=place.name))
    return found


def _sides(ring: list[list[float]]) -> Iterable[Point]:
    """The ends of every side of a closed ring."""
    return _steps([*ring, ring[0]], _OUTLINE_Z) if ring else ()


def _steps(line: list[list[float]], z: float) -> Iterable[Point]:
    """The ends of every piece of a line, as lists of lines have them."""
    for (x0, y0), (x1, y1) in zip(line, line[1:]):
        yield (x0, y0, z)
        yield (x1, y1, z)
