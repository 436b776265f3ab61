"""The topological map: places, doorways and how they connect. Coordinates are meters of the map frame."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._grid import Path
from .errors import NoRouteError, TopologyError

if TYPE_CHECKING:
    import geopandas
    import networkx
    import pandas
    from shapely.geometry import MultiPolygon, Polygon

Point: TypeAlias = "tuple[float, float]"

CRS = "EPSG:3857"
"""What files say of their coordinates: a projection in meters. It is not where the building stands."""


@dataclass(frozen=True)
class Ring:
    """A polygon of an outline: ``exterior`` (n, 2) counter-clockwise, ``holes`` clockwise; no ring repeats its first point."""

    exterior: NDArray[np.float64] = field(compare=False)
    holes: tuple[NDArray[np.float64], ...] = field(compare=False)


@dataclass(frozen=True)
class Axes:
    """Axes of a place's second moments, as scikit-image's ``regionprops`` has them, in meters; the direction of the major one."""

    major_m: float
    minor_m: float
    direction_rad: float


@dataclass(frozen=True, repr=False)
class Place:
    """A vertex of the topological map: one region."""

    id: int
    """Number of the place, from 1: its value in ``Result.regions``."""
    name: str
    """Unique name, by default class and number."""
    class_name: str
    """Name of its class."""
    role: str
    """Role of its class: ``"place"``, ``"passage"`` or ``"doorway"``."""
    probability: float
    """Mean probability of its class over its cells."""
    n_cells: int
    """Number of its cells."""
    area_m2: float
    """Area of its cells, in square meters."""
    centroid: Point
    """Mean of its cells' centers; may lie outside of a bent place."""
    axes: Axes
    """Axes of its cells' second moments."""
    anchor: Point
    """Center of its cell with the largest clearance: always inside."""
    clearance_m: float
    """Distance from the anchor to the nearest cell that is not this place's, in meters."""
    outline: tuple[Ring, ...] = field(compare=False)
    """Outline along the cells' sides; more than one polygon where cells touch at a corner only."""
    is_cut_off: bool
    """Whether no routes lead there from where the robot is, or from the largest part."""

    @property
    def polygon(self) -> Polygon | MultiPolygon:
        """The outline as a Shapely geometry. Needs Shapely (``placegraph[geo]``)."""
        from shapely.geometry import MultiPolygon, Polygon

        polygons = [Polygon(ring.exterior, ring.holes) for ring in self.outline]
        return polygons[0] if len(polygons) == 1 else MultiPolygon(polygons)

    def __repr__(self) -> str:
        x, y = self.anchor
        return f"<{self.name!r}: {self.class_name}, {self.area_m2:.1f} m² at ({x:.1f}, {y:.1f})>"


@dataclass(frozen=True, repr=False)
class Doorway(Place):
    """A place of the role doorway."""

    width_m: float
    """Clear width of the opening, in meters."""
    jambs: tuple[Point, Point]
    """Where the narrowest line across the opening meets the walls."""
    side_ids: tuple[int, ...]
    """Numbers of the places on its two sides; fewer at the edge of the explored area."""

    def __repr__(self) -> str:
        x, y = self.anchor
        return f"<{self.name!r}: {self.class_name}, {self.width_m:.2f} m wide at ({x:.1f}, {y:.1f})>"


@dataclass(frozen=True, repr=False)
class Connection:
    """An edge of the topological map: two places that touch."""

    a: Place
    """The place with the lower number."""
    b: Place
    """The place with the higher number."""
    contact_m: float
    """Length of the common border, in meters."""
    middle: Point
    """The point of the common border nearest to its mean."""
    length_m: float | None
    """Length of the way from station to station through free cells; ``None`` if there is none."""
    line: NDArray[np.float64] | None = field(compare=False)
    """(n, 2) corners of that way, from ``a`` to ``b``."""
    clearance_m: float | None
    """Distance of that way to the nearest cell that is not free, in meters, as far as it was looked for."""

    def __repr__(self) -> str:
        way = "no way" if self.length_m is None else f"{self.length_m:.1f} m"
        return f"<{self.a.name!r} - {self.b.name!r}: {way}>"


@dataclass(frozen=True)
class Location:
    """Where a point lies."""

    place: Place
    """The place it is in, or the nearest one."""
    is_inside: bool
    """Whether it is in that place; else it is on a wall, in unknown space or outside of the map."""
    distance_m: float
    """Distance to the border of that place, in meters."""


@dataclass(frozen=True)
class Itinerary:
    """The shortest way between two places."""

    places: tuple[Place, ...]
    """The places and doorways on the way, from the first to the last."""
    length_m: float
    """Its length, in meters."""
    line: NDArray[np.float64] = field(compare=False, repr=False)
    """(n, 2) corners of the way."""

    def __str__(self) -> str:
        return " → ".join(place.name for place in self.places) + f" ({self.length_m:.2f} m)"


class Topology:
    """The topological map of a result, or of a ``topology.json``.

    Indexing by name or number gives a place, iteration all of them.

    Parameters
    ----------
    document : str or bytes
        The text of a ``topology.json``.
    """

    def __init__(self, document: str | bytes) -> None:
        self._json = document.encode() if isinstance(document, str) else bytes(document)
        self._questions = _native.Questions(self._json)

    @classmethod
    def load(cls, path: Path) -> Topology:
        """Reads a ``topology.json``."""
        return cls(_native.read_file(os.fspath(path)))

    @cached_property
    def document(self) -> dict[str, Any]:
        """The whole document: docs/topology-json.md has its members."""
        document: dict[str, Any] = json.loads(self._json)
        return document

    def to_json(self) -> str:
        """The document as text, the bytes that the program writes."""
        return self._questions.to_json()

    @cached_property
    def places(self) -> tuple[Place, ...]:
        """All places by number, doorways among them."""
        return tuple(_place(each) for each in self.document["places"])

    @cached_property
    def doorways(self) -> tuple[Doorway, ...]:
        """The places of the role doorway."""
        return tuple(place for place in self.places if isinstance(place, Doorway))

    @cached_property
    def connections(self) -> tuple[Connection, ...]:
        """The connections, by the numbers of their ends."""
        return tuple(_connection(each, self._by_id) for each in self.document["connections"])

    def place(self, key: str | int | Place) -> Place:
        """The place of this name or number. Raises :class:`TopologyError` if there is none."""
        if isinstance(key, Place):
            key = key.id
        found = self._by_id.get(key) if isinstance(key, int) else self._by_name.get(key)
        if found is None and isinstance(key, str) and key.isdecimal():
            found = self._by_id.get(int(key))
        if found is None:
            raise TopologyError(f"expected the name or the number of a place, found {key!r}")
        return found

    def where(self, x: float, y: float) -> Location | None:
        """Which place the point (x, y) of the map frame lies in; ``None`` only for a map without places."""
        found = self._questions.locate(x, y)
        if found is None:
            return None
        is_inside, number, distance_m = found
        return Location(self._by_id[number], is_inside, distance_m)

    def route(self, start: str | int | Place, goal: str | int | Place) -> Itinerary:
        """The shortest way between two places, given by name or number. Raises :class:`NoRouteError` if there is none."""
        first, last = self.place(start), self.place(goal)
        found = self._questions.route(first.id, last.id)
        if found is None:
            raise NoRouteError(f"there is no route from {first.name} to {last.name}")
        numbers, length_m, line = found
        return Itinerary(tuple(self._by_id[number] for number in numbers), length_m, line)

    def to_networkx(self) -> networkx.Graph[int]:
        """A NetworkX graph with the attributes of the GraphML export; nodes are the places' numbers."""
        import networkx

        info = self.document["map"]
        origin = info["origin"]
        graph: networkx.Graph[int] = networkx.Graph(
            frame=info["frame_id"],
            resolution=info["resolution_m"],
            origin_x=origin["x"],
            origin_y=origin["y"],
            origin_yaw=origin["yaw_rad"],
        )
        for place in self.places:
            graph.add_node(place.id, **_attributes(place))
        for connection in self.connections:
            widths = [end.width_m for end in (connection.a, connection.b) if isinstance(end, Doorway)]
            known = {"length_m": connection.length_m, "width_m": min(widths, default=None)}
            known = {name: value for name, value in known.items() if value is not None}
            graph.add_edge(connection.a.id, connection.b.id, contact_m=connection.contact_m, **known)
        return graph

    def to_pandas(self) -> pandas.DataFrame:
        """A row per place, by number."""
        import pandas

        index = pandas.Index([place.id for place in self.places], name="id", dtype="int64")
        return pandas.DataFrame([_attributes(place) for place in self.places], index=index)

    def to_geopandas(self) -> geopandas.GeoDataFrame:
        """A row per place with its polygon, in meters of the map frame.

        The frame is stated as EPSG:3857, a projection in meters, as in the GeoJSON export; it is not where the
        building stands.
        """
        import geopandas

        return geopandas.GeoDataFrame(self.to_pandas(), geometry=[p.polygon for p in self.places], crs=CRS)

    @cached_property
    def _by_id(self) -> dict[int, Place]:
        return {place.id: place for place in self.places}

    @cached_property
    def _by_name(self) -> dict[str, Place]:
        return {place.name: place for place in self.places}

    def __getitem__(self, key: str | int) -> Place:
        return self.place(key)

    def __iter__(self) -> Iterator[Place]:
        return iter(self.places)

    def __len__(self) -> int:
        return len(self.places)

    def __contains__(self, key: object) -> bool:
        return key in self._by_id or key in self._by_name or (isinstance(key, Place) and key.id in self._by_id)

    def __repr__(self) -> str:
        return f"Topology({summary(self)})"

    def __reduce__(self) -> tuple[Any, ...]:
        return (Topology, (self._json,))


def as_topology(source: Topology | Path) -> Topology:
    """``source`` itself, or the topology in that file."""
    return source if isinstance(source, Topology) else Topology.load(source)


def summary(topology: Topology) -> str:
    """How many places of each class there are, and how many connections."""
    names = [each["name"] for each in topology.document["classes"]]
    counts = [(name, sum(place.class_name == name for place in topology.places)) for name in names]
    parts = [f"{n} {name}" for name, n in counts]
    return f"{', '.join(parts)}; {len(topology.connections)} connections"


def _attributes(place: Place) -> dict[str, Any]:
    attributes: dict[str, Any] = {
        "name": place.name,
        "class": place.class_name,
        "probability": place.probability,
        "area_m2": place.area_m2,
        "x": place.centroid[0],
        "y": place.centroid[1],
        "major_m": place.axes.major_m,
        "minor_m": place.axes.minor_m,
        "direction_rad": place.axes.direction_rad,
        "anchor_x": place.anchor[0],
        "anchor_y": place.anchor[1],
        "clearance_m": place.clearance_m,
    }
    if isinstance(place, Doorway):
        attributes["width_m"] = place.width_m
    return attributes


def _point(value: dict[str, float]) -> Point:
    return (value["x"], value["y"])


def _points(values: list[dict[str, float]]) -> NDArray[np.float64]:
    points = np.array([_point(value) for value in values], dtype=np.float64).reshape(-1, 2)
    points.flags.writeable = False
    return points


def _place(value: dict[str, Any]) -> Place:
    rings = (Ring(_points(part["exterior"]), tuple(map(_points, part["holes"]))) for part in value["outline"])
    fields: dict[str, Any] = {
        "id": value["id"],
        "name": value["name"],
        "class_name": value["class"],
        "role": value["role"],
        "probability": value["probability"],
        "n_cells": value["n_cells"],
        "area_m2": value["area_m2"],
        "centroid": _point(value["centroid"]),
        "axes": Axes(**value["axes"]),
        "anchor": _point(value["anchor"]),
        "clearance_m": value["clearance_m"],
        "outline": tuple(rings),
        "is_cut_off": value.get("cut_off", False),
    }
    doorway = value.get("doorway")
    if doorway is None:
        return Place(**fields)
    first, second = doorway["jambs"]
    jambs, sides = (_point(first), _point(second)), tuple(doorway["sides"])
    return Doorway(**fields, width_m=doorway["width_m"], jambs=jambs, side_ids=sides)


def _connection(value: dict[str, Any], places: dict[int, Place]) -> Connection:
    route = value.get("route")
    ends = places[value["a"]], places[value["b"]]
    border = value["contact_m"], _point(value["middle"])
    if route is None:
        return Connection(*ends, *border, None, None, None)
    return Connection(*ends, *border, route["length_m"], _points(route["line"]), route.get("clearance_m"))
