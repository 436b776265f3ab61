"""A labeled map as rows of four tables: what the data set holds."""

from __future__ import annotations

import json
import struct
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from .._grid import OccupancyGrid
from .._topology import CRS, Connection, Doorway, Place, Ring, Topology

Row = dict[str, Any]

_KEY = [("key", pa.string()), ("site", pa.string())]
_POINT = [("x", pa.float64()), ("y", pa.float64())]
_GEOMETRY = [("geometry", pa.binary())]

SCHEMAS: dict[str, pa.Schema] = {
    # One row per map: what was labeled with what, or why it could not be.
    "maps": pa.schema(
        [
            *_KEY,
            ("map", pa.string()),
            ("status", pa.string()),
            ("error", pa.string()),
            ("map_hash", pa.string()),
            ("model", pa.string()),
            ("model_hash", pa.string()),
            ("options", pa.string()),
            ("version", pa.string()),
            ("resolution_m", pa.float64()),
            ("width", pa.int64()),
            ("height", pa.int64()),
            ("n_places", pa.int64()),
            ("n_doorways", pa.int64()),
            ("n_connections", pa.int64()),
            ("area_m2", pa.float64()),
            ("findings", pa.list_(pa.string())),
            ("topology", pa.string()),
            *_GEOMETRY,
        ]
    ),
    # One row per place, doorways among them: its outline.
    "places": pa.schema(
        [
            *_KEY,
            ("id", pa.int64()),
            ("name", pa.string()),
            ("class", pa.string()),
            ("role", pa.string()),
            ("probability", pa.float64()),
            ("n_cells", pa.int64()),
            ("area_m2", pa.float64()),
            *_POINT,
            ("anchor_x", pa.float64()),
            ("anchor_y", pa.float64()),
            ("clearance_m", pa.float64()),
            ("major_m", pa.float64()),
            ("minor_m", pa.float64()),
            ("direction_rad", pa.float64()),
            *_GEOMETRY,
        ]
    ),
    # One row per doorway: the line from jamb to jamb.
    "doorways": pa.schema(
        [
            *_KEY,
            ("id", pa.int64()),
            ("name", pa.string()),
            ("width_m", pa.float64()),
            ("side_a", pa.int64()),
            ("side_b", pa.int64()),
            *_POINT,
            *_GEOMETRY,
        ]
    ),
    # One row per connection: the way from station to station.
    "connections": pa.schema(
        [
            *_KEY,
            ("a", pa.int64()),
            ("b", pa.int64()),
            ("contact_m", pa.float64()),
            ("length_m", pa.float64()),
            ("width_m", pa.float64()),
            *_GEOMETRY,
        ]
    ),
}

_GEOMETRY_TYPES = {
    "maps": ["Polygon"],
    "places": ["MultiPolygon", "Polygon"],
    "doorways": ["LineString"],
    "connections": ["LineString"],
}


def rows_of(key: str, site: str, map: OccupancyGrid, topology: Topology) -> dict[str, list[Row]]:
    """The rows of all tables but ``maps``."""
    head = {"key": key, "site": site}
    return {
        "places": [head | _place(place) for place in topology.places],
        "doorways": [head | _doorway(doorway) for doorway in topology.doorways],
        "connections": [head | _connection(connection) for connection in topology.connections],
    }


def table_of(name: str, rows: Sequence[Row]) -> pa.Table:
    """``rows`` as a GeoParquet table."""
    schema = SCHEMAS[name]
    table = pa.Table.from_pylist(list(rows), schema=schema)
    column = {
        "encoding": "WKB",
        "geometry_types": _GEOMETRY_TYPES[name],
        "crs": _PROJJSON,
        "edges": "planar",
    }
    geo = {"version": "1.1.0", "primary_column": "geometry", "columns": {"geometry": column}}
    return table.replace_schema_metadata({"geo": json.dumps(geo, sort_keys=True)})


def outline_of(map: OccupancyGrid) -> bytes:
    """The rectangle of the map, in the map frame."""
    height, width = map.shape
    (x, y, yaw), resolution = map.origin, map.resolution
    corners = np.array([(0, 0), (width, 0), (width, height), (0, height)], dtype=np.float64) * resolution
    cos, sin = np.cos(yaw), np.sin(yaw)
    turned = corners @ np.array([(cos, sin), (-sin, cos)]) + (x, y)
    return _wkb_polygon(Ring(turned, ()))


def _place(place: Place) -> Row:
    return {
        "id": place.id,
        "name": place.name,
        "class": place.class_name,
        "role": place.role,
        "probability": place.probability,
        "n_cells": place.n_cells,
        "area_m2": place.area_m2,
        "x": place.centroid[0],
        "y": place.centroid[1],
        "anchor_x": place.anchor[0],
        "anchor_y": place.anchor[1],
        "clearance_m": place.clearance_m,
        "major_m": place.axes.major_m,
        "minor_m": place.axes.minor_m,
        "direction_rad": place.axes.direction_rad,
        "geometry": _wkb_outline(place.outline),
    }


def _doorway(doorway: Doorway) -> Row:
    side_a, side_b = (*doorway.side_ids, None, None)[:2]
    (x0, y0), (x1, y1) = doorway.jambs
    return {
        "id": doorway.id,
        "name": doorway.name,
        "width_m": doorway.width_m,
        "side_a": side_a,
        "side_b": side_b,
        "x": (x0 + x1) / 2,
        "y": (y0 + y1) / 2,
        "geometry": _wkb_line(np.array(doorway.jambs)),
    }


def _connection(connection: Connection) -> Row:
    widths = [end.width_m for end in (connection.a, connection.b) if isinstance(end, Doorway)]
    line = connection.line
    return {
        "a": connection.a.id,
        "b": connection.b.id,
        "contact_m": connection.contact_m,
        "length_m": connection.length_m,
        "width_m": min(widths, default=None),
        # A line has two points at least.
        "geometry": None if line is None or len(line) < 2 else _wkb_line(line),
    }


# Well-known binary, little endian: kind 2 a line, 3 a polygon, 6 several polygons.


def _wkb_points(points: NDArray[np.float64]) -> bytes:
    return struct.pack("<I", len(points)) + points.astype("<f8").tobytes()


def _wkb_line(points: NDArray[np.float64]) -> bytes:
    return struct.pack("<BI", 1, 2) + _wkb_points(points)


def _wkb_polygon(part: Ring) -> bytes:
    rings: Iterable[NDArray[np.float64]] = (part.exterior, *part.holes)
    closed = [_wkb_points(np.vstack([ring, ring[:1]])) for ring in rings]
    return struct.pack("<BII", 1, 3, len(closed)) + b"".join(closed)


def _wkb_outline(outline: Sequence[Ring]) -> bytes:
    parts = [_wkb_polygon(part) for part in outline]
    return parts[0] if len(parts) == 1 else struct.pack("<BII", 1, 6, len(parts)) + b"".join(parts)


def _axis(name: str, abbreviation: str, direction: str) -> Row:
    return {"name": name, "abbreviation": abbreviation, "direction": direction, "unit": "metre"}


_GREENWICH_DEGREES = {
    "type": "GeographicCRS",
    "name": "WGS 84",
    "datum": {
        "type": "GeodeticReferenceFrame",
        "name": "World Geodetic System 1984",
        "ellipsoid": {"name": "WGS 84", "semi_major_axis": 6378137, "inverse_flattening": 298.257223563},
    },
    "coordinate_system": {
        "subtype": "ellipsoidal",
        "axis": [
            {"name": "Geodetic latitude", "abbreviation": "Lat", "direction": "north", "unit": "degree"},
            {"name": "Geodetic longitude", "abbreviation": "Lon", "direction": "east", "unit": "degree"},
        ],
    },
    "id": {"authority": "EPSG", "code": 4326},
}


def _parameter(name: str, unit: str, code: int) -> Row:
    return {"name": name, "value": 0, "unit": unit, "id": {"authority": "EPSG", "code": code}}


_PROJJSON: Row = {
    "$schema": "https://proj.org/schemas/v0.7/projjson.schema.json",
    "type": "ProjectedCRS",
    "name": "WGS 84 / Pseudo-Mercator",
    "base_crs": _GREENWICH_DEGREES,
    "conversion": {
        "name": "Popular Visualisation Pseudo-Mercator",
        "method": {
            "name": "Popular Visualisation Pseudo Mercator",
            "id": {"authority": "EPSG", "code": 1024},
        },
        "parameters": [
            _parameter("Latitude of natural origin", "degree", 8801),
            _parameter("Longitude of natural origin", "degree", 8802),
            _parameter("False easting", "metre", 8806),
            _parameter("False northing", "metre", 8807),
        ],
    },
    "coordinate_system": {
        "subtype": "Cartesian",
        "axis": [_axis("Easting", "X", "east"), _axis("Northing", "Y", "north")],
    },
    "id": {"authority": CRS.partition(":")[0], "code": int(CRS.partition(":")[2])},
}
