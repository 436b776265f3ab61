"""From a robot's occupancy grid map to corridors, rooms, doorways and how they connect.

>>> import placegraph as pg
>>> result = pg.label("maps/office/map.yaml")
>>> len(result.doorways)
16

Arrays have row 0 at the top of the map; everything in meters is in the map frame. docs/python.md is the manual.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from . import errors
from ._grid import Finding, OccupancyGrid, load_map
from ._learning import Building, ClassScores, Scores, evaluate, feature_names, features, generate, train
from ._model import ClassInfo, Model, default_model, load_model
from ._native import VERSION
from ._result import Result, Session, export_formats, label
from ._topology import Axes, Connection, Doorway, Itinerary, Location, Place, Ring, Topology
from .errors import (
    EditError,
    Error,
    ExportError,
    FileError,
    InternalError,
    MapError,
    MissingFileError,
    ModelError,
    NoRouteError,
    TopologyError,
    TrainingError,
)

if TYPE_CHECKING:
    from . import fleet
    from .classifier import PlaceClassifier

__version__ = VERSION

__all__ = [
    "Axes",
    "Building",
    "ClassInfo",
    "ClassScores",
    "Connection",
    "Doorway",
    "EditError",
    "Error",
    "ExportError",
    "FileError",
    "Finding",
    "InternalError",
    "Itinerary",
    "Location",
    "MapError",
    "MissingFileError",
    "Model",
    "ModelError",
    "NoRouteError",
    "OccupancyGrid",
    "Place",
    "PlaceClassifier",
    "Result",
    "Ring",
    "Scores",
    "Session",
    "Topology",
    "TopologyError",
    "TrainingError",
    "default_model",
    "errors",
    "evaluate",
    "export_formats",
    "feature_names",
    "features",
    "fleet",
    "generate",
    "label",
    "load_map",
    "load_model",
    "train",
]


def __getattr__(name: str) -> Any:
    # What needs more than NumPy is imported when it is asked for.
    if name == "PlaceClassifier":
        from .classifier import PlaceClassifier

        return PlaceClassifier
    if name == "fleet":
        from importlib import import_module

        return import_module(".fleet", __name__)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted([*globals(), "PlaceClassifier", "fleet"])
