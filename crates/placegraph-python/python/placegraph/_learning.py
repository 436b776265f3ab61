"""Features, training, evaluation, and generated buildings."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._grid import OccupancyGrid, Path, as_map
from ._model import ClassInfo, Model, default_model
from ._result import Result
from .errors import TrainingError

FeatureSet: TypeAlias = Literal["all", "freiburg203", "chapter183", "old152", "lean120"]
Classes: TypeAlias = "Sequence[str | ClassInfo] | Mapping[str, str]"

# Colors of classes that name none.
_COLORS = ((86, 156, 214), (244, 200, 120), (206, 68, 84), (120, 190, 130), (150, 120, 200))
_ROLES = {"corridor": "passage", "doorway": "doorway"}


def feature_names(features: FeatureSet = "all") -> tuple[str, ...]:
    """The names of the features of a set, in the order of :func:`features`; docs/features.md has the formulas."""
    return tuple(_native.feature_names(features))


def features(
    map: OccupancyGrid | Path,
    *,
    names: Sequence[str] | None = None,
    model: Model | None = None,
    threads: int | None = None,
) -> tuple[NDArray[np.float32], NDArray[np.int64]]:
    """The features of the scan in every free cell of a map.

    Parameters
    ----------
    map : OccupancyGrid or path
        The map.
    names : sequence of str, optional
        The features; by default all of :func:`feature_names`.
    model : Model, optional
        Whose scan is simulated; by default one without limit of range.
    threads : int, optional
        Number of threads; by default one a core.

    Returns
    -------
    values : ndarray, (n, F) float32
        A row per free cell, a column per feature.
    cells : ndarray, (n, 2) int64
        Row and column of the cells: ``labels[cells[:, 0], cells[:, 1]]`` are theirs. From the bottom row up.
    """
    wanted = feature_names() if names is None else names
    native = None if model is None else model._handle
    values, cells = _native.extract(as_map(map)._handle, list(wanted), native, threads)
    return values.T, cells


def train(
    maps: Iterable[tuple[OccupancyGrid | Path, ArrayLike]],
    *,
    classes: Classes = ("corridor", "room", "doorway"),
    method: Literal["boosted", "iamn"] = "boosted",
    chapter: bool = False,
    features: FeatureSet | None = None,
    rounds: int | None = None,
    temperature: float | None = None,
    scales: Sequence[float] | None = None,
    max_speck: float | None = None,
    max_cells_per_class: int | None = None,
    name: str = "model",
    threads: int | None = None,
) -> Model:
    """Trains a model on labeled maps.

    Parameters
    ----------
    maps : iterable of (map, labels)
        Maps with their labels, (H, W) of integers: 0 or 255 none, k the k-th of ``classes`` from 1. Scans see the
        whole map; only free cells with a label are learned from.
    classes : sequence or mapping, optional
        Names of the classes in the order of their labels; a mapping has their roles: ``"place"``, ``"passage"`` or
        ``"doorway"``. Without one, corridor is a passage, doorway a doorway, and every other class a place.
    method : {"boosted", "iamn"}
        Decision list and relaxation, or associative Markov network.
    chapter : bool
        The chapter's own setting: 100 rounds, temperature 1.
    features : str, optional
        The set of features to choose from.
    rounds, temperature : optional
        Chosen by cross-validation where they are not given.
    scales : sequence of float, optional
        Train on the building at these scales.
    max_speck : float, optional
        When maps are labeled, scans pass through obstacles that stand free and are at most this long and wide, in
        meters.
    max_cells_per_class : int, optional
        Train on at most so many cells of each class, evenly taken.
    name : str
        What results call the model.
    threads : int, optional
        Number of threads; by default one a core.

    Raises
    ------
    TrainingError
        If a setting is out of range, labels do not fit their map or the classes, or a class has no cell.
    """
    pairs = [(as_map(map)._handle, _labels(labels)) for map, labels in maps]
    settings: _native._TrainSettings = {
        "method": method,
        "chapter": chapter,
        "features": features,
        "rounds": rounds,
        "temperature": temperature,
        "scales": None if scales is None else [float(scale) for scale in scales],
        "max_speck_m": max_speck,
        "max_cells_per_class": max_cells_per_class,
    }
    return Model._of(_native.train_model(pairs, _specs(classes), settings, name, threads))


@dataclass(frozen=True)
class ClassScores:
    """Rates of one class; ``None`` where a rate would be 0/0."""

    name: str
    n_cells: int
    precision: float | None
    recall: float | None
    f1: float | None
    iou: float | None


@dataclass(frozen=True)
class Scores:
    """How good labels are; ``None`` where nothing was counted. ``str`` gives a table."""

    n_cells: int
    """Number of cells with a true label; only they count."""
    accuracy: float | None
    """Correct cells among them."""
    accuracy_within_one_cell: float | None
    """The same, where a label that the truth has within one cell counts as correct."""
    macro_f1: float | None
    """Mean F1 of the classes that occur."""
    classes: tuple[ClassScores, ...]
    """The rates of every class."""
    confusion: NDArray[np.int64] = field(compare=False)
    """(K, K + 1) cells by true class (row) and predicted class (column); the last column has those without a label."""
    _text: str = field(repr=False, compare=False)

    def __str__(self) -> str:
        return self._text


def evaluate(
    predicted: Result | ArrayLike, truth: ArrayLike, *, classes: Classes | None = None
) -> Scores:
    """Compares labels with the truth, cell by cell.

    ``predicted`` and ``truth`` are (H, W) of integers: 0 or 255 none, k the k-th class from 1; only cells with a true
    label count. ``classes`` are those of the result, or corridor, room and doorway.
    """
    if classes is None:
        classes = predicted.classes if isinstance(predicted, Result) else default_model().classes
    labels = _labels(predicted.labels if isinstance(predicted, Result) else predicted)
    true_labels = _labels(truth)
    if labels.shape != true_labels.shape:
        raise ValueError(f"expected labels of the shape {true_labels.shape} of the truth, found {labels.shape}")
    text, table = _native.evaluate(labels, true_labels, _specs(classes))
    scores = json.loads(text)
    return Scores(
        n_cells=scores["n_cells"],
        accuracy=scores["accuracy"],
        accuracy_within_one_cell=scores["accuracy_within_one_cell"],
        macro_f1=scores["macro_f1"],
        classes=tuple(ClassScores(**each) for each in scores["classes"]),
        confusion=np.array(scores["confusion"]["counts"], dtype=np.int64),
        _text=table,
    )


@dataclass(frozen=True)
class Building:
    """A generated building: its map, and the truth of the map."""

    map: OccupancyGrid
    """The map."""
    labels: NDArray[np.uint8] = field(repr=False, compare=False)
    """(H, W) uint8: 1 corridor, 2 room, 3 doorway, 255 ambiguous, 0 where there is no free cell."""
    rooms: NDArray[np.uint16] = field(repr=False, compare=False)
    """(H, W) uint16: number of the room from 1; 0 where there is none."""
    graph: dict[str, Any] = field(repr=False, compare=False)
    """Mapped rooms and the openings between them."""
    style: str
    """Kind of building."""
    mapping: str
    """How the map came about."""
    _files: dict[str, bytes] = field(repr=False, compare=False)

    def save(self, folder: Path) -> str:
        """Writes ``map.yaml``, ``map.png``, ``labels.png``, ``rooms.png`` and ``graph.json``; returns the map's path."""
        os.makedirs(folder, exist_ok=True)
        for name, data in self._files.items():
            _native.write_file(os.path.join(folder, name), data)
        return os.path.join(folder, "map.yaml")


def generate(
    *,
    style: Literal["office", "home", "hospital", "hotel", "school", "warehouse", "mixed"] = "mixed",
    seed: int = 1,
    index: int = 0,
    mapping: Literal["slam", "clean", "furnished", "mixed"] = "mixed",
    resolution: float | None = None,
    name: str = "map",
) -> Building:
    """Makes a building with perfect labels, as a robot would map it: the same arguments, the same building.

    ``index`` counts the buildings of a series; ``resolution`` is 0.02 to 0.2 m per cell, drawn if it is not given.
    """
    grid, labels, rooms, graph, kinds, files = _native.generate(style, seed, index, mapping, resolution, name)
    return Building(OccupancyGrid._of(grid), labels, rooms, json.loads(graph), *kinds, dict(files))


def _labels(labels: ArrayLike) -> NDArray[np.uint8]:
    values = np.asarray(labels)
    if values.ndim != 2:
        raise TypeError(f"expected labels of 2 dimensions (rows, columns), found {values.ndim}")
    if values.dtype.kind not in "iu":
        raise TypeError(f"expected labels of an integer type, found {values.dtype}")
    if values.size == 0:
        raise TrainingError(f"expected labels of at least one cell, found the shape {values.shape}")
    if values.min() < 0 or values.max() > 255:
        raise TrainingError(f"expected labels of 0 to 255, found {values.min()} to {values.max()}")
    return values.astype(np.uint8, copy=False)


def _specs(classes: Classes) -> list[tuple[str, str, tuple[int, int, int]]]:
    if isinstance(classes, str):
        raise TypeError(f"expected a sequence or a mapping of classes, found {classes!r}")
    roles = classes if isinstance(classes, Mapping) else {}
    specs = []
    for k, each in enumerate(classes):
        if isinstance(each, ClassInfo):
            specs.append((each.name, each.role, each.color))
        else:
            role = roles.get(each, _ROLES.get(each, "place"))
            specs.append((each, role, _COLORS[k % len(_COLORS)]))
    return specs
