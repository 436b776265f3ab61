"""The robot's place from TF, with stand-ins for what needs ROS."""

from __future__ import annotations

import sys
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest

from placegraph_ros.transforms import follow_frame


class Node:
    def __init__(self) -> None:
        self.warnings: list[str] = []
        self.look: Any = None

    def create_timer(self, _period_s: float, look: Any) -> object:
        self.look = look
        return object()

    def get_logger(self) -> Any:
        return SimpleNamespace(warning=lambda text, **_: self.warnings.append(text))


def test_the_frame_is_followed(monkeypatch: pytest.MonkeyPatch) -> None:
    class TransformException(Exception):
        pass

    asked: list[tuple[str, str]] = []

    class Buffer:
        def lookup_transform(self, target: str, source: str, _time: object) -> Any:
            asked.append((target, source))
            if len(asked) == 1:
                raise TransformException("no connection")
            return SimpleNamespace(transform=SimpleNamespace(translation=SimpleNamespace(x=1.5, y=-2.0)))

    tf2_ros, time = ModuleType("tf2_ros"), ModuleType("rclpy.time")
    tf2_ros.Buffer, tf2_ros.TransformException = Buffer, TransformException  # type: ignore[attr-defined]
    tf2_ros.TransformListener = lambda buffer, node: object()  # type: ignore[attr-defined]
    time.Time = object  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "tf2_ros", tf2_ros)
    monkeypatch.setitem(sys.modules, "rclpy", ModuleType("rclpy"))
    monkeypatch.setitem(sys.modules, "rclpy.time", time)
    node, frame, seen = Node(), [None], []  # type: ignore[var-annotated]
    assert follow_frame(node, "base_link", lambda: frame[0], lambda x, y: seen.append((x, y)))
    node.look()
    assert asked == [] and seen == [], "there is no map yet"
    frame[0] = "map"  # type: ignore[call-overload]
    node.look()
    assert seen == [] and "no connection" in node.warnings[0]
    node.look()
    assert seen == [(1.5, -2.0)] and asked == [("map", "base_link")] * 2


def test_without_tf2_it_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "tf2_ros", None)
    assert not follow_frame(Node(), "base_link", lambda: "map", lambda x, y: None)
