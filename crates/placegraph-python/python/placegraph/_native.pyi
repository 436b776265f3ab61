"""Arrays and text in and out of the library: what the Python code of this package is made from."""

from typing import TypedDict, final

import numpy as np
from numpy.typing import NDArray

_Frame = tuple[float, tuple[float, float, float]]
_Class = tuple[str, str, tuple[int, int, int]]
_Stumps = tuple[NDArray[np.uint16], NDArray[np.float32], NDArray[np.bool_], NDArray[np.float64]]

class _TrainSettings(TypedDict):
    method: str
    chapter: bool
    features: str | None
    rounds: int | None
    temperature: float | None
    scales: list[float] | None
    max_speck_m: float | None
    max_cells_per_class: int | None

__all__ = [
    "Grid",
    "Labeled",
    "Model",
    "Questions",
    "Session",
    "VERSION",
    "evaluate",
    "export_formats",
    "extract",
    "feature_names",
    "fit_list",
    "generate",
    "label",
    "list_probabilities",
    "read_file",
    "run_program",
    "train_model",
    "write_file",
]
VERSION: str

@final
class Grid:
    @staticmethod
    def load(
        path: str,
        resolution: float | None,
        rules: str,
        gray_205_as_file: bool,
        allow_outside: bool,
        max_cells: int,
    ) -> Grid: ...
    @staticmethod
    def from_occupancy(
        array: NDArray[np.int8], frame: _Frame, thresholds: tuple[float, float], name: str
    ) -> Grid: ...
    @staticmethod
    def from_gray(
        array: NDArray[np.uint8],
        frame: _Frame,
        thresholds: tuple[float, float],
        name: str,
        negate: bool,
        gray_205_as_file: bool,
    ) -> Grid: ...
    @property
    def name(self) -> str: ...
    @property
    def hash(self) -> str: ...
    @property
    def resolution(self) -> float: ...
    @property
    def origin(self) -> tuple[float, float, float]: ...
    @property
    def shape(self) -> tuple[int, int]: ...
    def array(self) -> NDArray[np.int8]: ...
    def findings(self) -> list[tuple[str, str, str]]: ...
    def scan(self, x: float, y: float, model: Model | None) -> NDArray[np.float64]: ...
    def cell_at(self, x: float, y: float) -> tuple[int, int] | None: ...

@final
class Model:
    @staticmethod
    def load(path: str) -> Model: ...
    @staticmethod
    def default() -> Model: ...
    @staticmethod
    def from_bytes(data: bytes, name: str) -> Model: ...
    def to_bytes(self) -> bytes: ...
    @property
    def name(self) -> str: ...
    @property
    def hash(self) -> str: ...
    @property
    def method(self) -> str: ...
    @property
    def classes(self) -> list[_Class]: ...
    @property
    def record(self) -> str: ...
    @property
    def feature_names(self) -> list[str]: ...

@final
class Labeled:
    def labels(self) -> NDArray[np.uint8]: ...
    def regions(self) -> NDArray[np.uint32]: ...
    def probabilities(self) -> NDArray[np.float32]: ...
    def classified(self) -> NDArray[np.uint8]: ...
    def topology_json(self) -> str: ...
    def changes_json(self) -> str: ...
    def overview_png(self) -> bytes: ...
    def save(
        self,
        folder: str,
        export: list[str],
        masks: str | None,
        stages: bool,
        probabilities: bool,
        georeference: tuple[float, float, float] | None,
    ) -> list[str]: ...
    def export(
        self, format: str, path: str, masks: str | None, georeference: tuple[float, float, float] | None
    ) -> list[str]: ...

@final
class Session:
    def __new__(cls, model: Model) -> Session: ...

@final
class Questions:
    def __new__(cls, json: bytes) -> Questions: ...
    def to_json(self) -> str: ...
    def locate(self, x: float, y: float) -> tuple[bool, int, float] | None: ...
    def route(self, start: int, goal: int) -> tuple[list[int], float, NDArray[np.float64]] | None: ...

def run_program(args: list[str]) -> int: ...
def read_file(path: str) -> bytes: ...
def write_file(path: str, data: bytes) -> None: ...
def export_formats() -> list[tuple[str, str]]: ...
def label(
    grid: Grid,
    model: Model,
    previous: bytes | None,
    edits: str | None,
    doorways: bool,
    correction: bool,
    align: bool,
    hold: bool,
    robot: tuple[float, tuple[float, float] | None],
    threads: int | None,
    session: Session | None,
) -> Labeled: ...
def feature_names(set: str) -> list[str]: ...
def extract(
    grid: Grid, names: list[str], model: Model | None, threads: int | None
) -> tuple[NDArray[np.float32], NDArray[np.int64]]: ...
def train_model(
    maps: list[tuple[Grid, NDArray[np.uint8]]],
    classes: list[_Class],
    settings: _TrainSettings,
    name: str,
    threads: int | None,
) -> Model: ...
def evaluate(predicted: NDArray[np.uint8], truth: NDArray[np.uint8], classes: list[_Class]) -> tuple[str, str]: ...
def generate(
    style: str, seed: int, index: int, mapping: str, resolution: float | None, name: str
) -> tuple[
    Grid, NDArray[np.uint8], NDArray[np.uint16], str, tuple[str, str], list[tuple[str, bytes]]
]: ...
def fit_list(
    x: NDArray[np.float32],
    y: NDArray[np.uint8],
    n_classes: int,
    n_rounds: int,
    temperature: float,
    threads: int | None,
) -> tuple[list[int], list[_Stumps]]: ...
def list_probabilities(
    x: NDArray[np.float32],
    order: list[int],
    classifiers: list[_Stumps],
    temperature: float,
    threads: int | None,
) -> NDArray[np.float32]: ...
