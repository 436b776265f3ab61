"""Trained models."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from . import _native
from ._grid import Path


@dataclass(frozen=True)
class ClassInfo:
    """A class of cells: its name, its role (``"place"``, ``"passage"`` or ``"doorway"``), its color (r, g, b)."""

    name: str
    role: str
    color: tuple[int, int, int]


class Model:
    """All that labeling a map needs to know. From :func:`default_model`, :func:`load_model` or :func:`train`.

    Models are immutable, and pickle as the bytes of their file.
    """

    __slots__ = ("_handle",)
    _handle: _native.Model

    def __init__(self) -> None:
        raise TypeError("models come from placegraph.default_model, load_model or train")

    @classmethod
    def _of(cls, native: _native.Model) -> Model:
        self = cls.__new__(cls)
        self._handle = native
        return self

    @classmethod
    def from_bytes(cls, data: bytes, *, name: str = "model") -> Model:
        """The model in the bytes of a model file."""
        return cls._of(_native.Model.from_bytes(data, name))

    def to_bytes(self) -> bytes:
        """The bytes of the model's file: the same model gives the same bytes."""
        return self._handle.to_bytes()

    @property
    def name(self) -> str:
        """What results call the model."""
        return self._handle.name

    @property
    def hash(self) -> str:
        """SHA-256 of the model's file, in hexadecimal."""
        return self._handle.hash

    @property
    def method(self) -> str:
        """``"boosted"`` (decision list and relaxation) or ``"iamn"`` (associative Markov network)."""
        return self._handle.method

    @property
    def classes(self) -> tuple[ClassInfo, ...]:
        """The classes; label k in arrays is ``classes[k - 1]``."""
        return tuple(ClassInfo(name, role, (r, g, b)) for name, role, (r, g, b) in self._handle.classes)

    @property
    def feature_names(self) -> tuple[str, ...]:
        """The features that the decision list looks at."""
        return tuple(self._handle.feature_names)

    @property
    def record(self) -> dict[str, Any]:
        """Where the model comes from: maps, settings, what held-out cells said."""
        record: dict[str, Any] = json.loads(self._handle.record)
        return record

    def save(self, path: Path) -> None:
        """Writes the model's file, whole or not at all."""
        _native.write_file(os.fspath(path), self.to_bytes())

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Model) and self.hash == other.hash

    def __hash__(self) -> int:
        return hash(self.hash)

    def __repr__(self) -> str:
        names = ", ".join(each.name for each in self.classes)
        return f"Model({self.name!r}, {self.method}, classes {names})"

    def __reduce__(self) -> tuple[Any, ...]:
        return (_unpickled, (self.to_bytes(), self.name))


def _unpickled(data: bytes, name: str) -> Model:
    return Model.from_bytes(data, name=name)


def load_model(path: Path) -> Model:
    """Reads a model file, as :meth:`Model.save` and ``placegraph train`` write it."""
    return Model._of(_native.Model.load(os.fspath(path)))


@lru_cache(maxsize=1)
def default_model() -> Model:
    """The model that comes with the package, for corridors, rooms and doorways of buildings."""
    return Model._of(_native.Model.default())


def as_model(model: Model | Path | None) -> Model:
    """``model`` itself, the model in that file, or the default one."""
    if model is None:
        return default_model()
    return model if isinstance(model, Model) else load_model(model)
