"""The parameters of the node: one table, checked as a whole."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import placegraph as pg

TOPICS = (
    "labels",
    "regions",
    "region_image",
    "markers",
    "topology",
    "route_graph",
    "keepout_mask",
    "speed_mask",
)
"""What can be published besides the status and the answers."""


class SettingError(ValueError):
    """A parameter has a value that cannot be."""


@dataclass(frozen=True)
class Settings:
    """The values of all parameters; docs/ros2.md says what each does."""

    model: str = ""
    previous: str = ""
    edits: str = ""
    masks: str = ""
    map_name: str = "map"
    follow: str = "live"
    min_interval_s: float = 2.0
    robot_radius_m: float = 0.0
    occupied_thresh: float = 0.65
    free_thresh: float = 0.196
    threads: int = 0
    topics: tuple[str, ...] = TOPICS
    exports: tuple[str, ...] = ("nav2",)
    output_folder: str = ""
    base_frame: str = ""
    border_margin_m: float = 0.3

    AT_START_ONLY = frozenset({"previous", "map_name", "topics", "base_frame"})
    """What a running node does not change."""

    RELABEL = frozenset({"model", "edits", "masks", "robot_radius_m", "occupied_thresh", "free_thresh"})
    """What changes results: the map is labeled again."""

    @classmethod
    def defaults(cls) -> dict[str, Any]:
        """Name and default of every parameter, of types that ROS knows."""
        return {each.name: _plain(each.default) for each in fields(cls)}

    @classmethod
    def read(cls, values: Mapping[str, Any]) -> Settings:
        """The settings with these values. Raises :class:`SettingError` with the name of the parameter and what to do."""
        given = dict(values)
        for name in ("topics", "exports"):
            # A parameter file cannot hold an empty list: [""] stands for it.
            given[name] = tuple(word for word in given.get(name, ()) if word)
        settings = cls(**given)
        settings._check()
        return settings

    def changed(self, other: Settings) -> frozenset[str]:
        """Names of the parameters whose values differ."""
        return frozenset(each.name for each in fields(self) if getattr(self, each.name) != getattr(other, each.name))

    def _check(self) -> None:
        _one_of("follow", self.follow, ("live", "frozen"))
        for name in self.topics:
            _one_of("topics", name, TOPICS)
        for name in self.exports:
            _one_of("exports", name, tuple(pg.export_formats()))
        for name in ("model", "previous", "edits", "masks"):
            path = getattr(self, name)
            if path and not Path(path).is_file():
                raise SettingError(f"parameter {name}: there is no file {path!r}; give its absolute path")
        _within("min_interval_s", self.min_interval_s, 0, 3600)
        _within("robot_radius_m", self.robot_radius_m, 0, 100)
        _within("border_margin_m", self.border_margin_m, 0, 10)
        _within("threads", self.threads, 0, 1024)
        _within("free_thresh", self.free_thresh, 0, 1)
        _within("occupied_thresh", self.occupied_thresh, 0, 1)
        if self.free_thresh >= self.occupied_thresh:
            raise SettingError(
                f"parameter free_thresh: expected less than occupied_thresh ({self.occupied_thresh:g}), "
                f"found {self.free_thresh:g}"
            )


def _plain(value: Any) -> Any:
    return list(value) if isinstance(value, tuple) else value


def _one_of(name: str, value: str, known: tuple[str, ...]) -> None:
    if value not in known:
        raise SettingError(f"parameter {name}: expected one of {', '.join(known)}, found {value!r}")


def _within(name: str, value: float, least: float, most: float) -> None:
    if not (math.isfinite(value) and least <= value <= most):
        raise SettingError(f"parameter {name}: expected {least} to {most}, found {value:g}")
