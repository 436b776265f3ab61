"""CostmapFilterInfo, with a stand-in: there is no wheel of nav2_msgs. The rest of the node is real."""

from __future__ import annotations

import sys
from types import ModuleType, SimpleNamespace
from typing import Any

import placegraph as pg
import pytest
from conftest import map_message

from placegraph_ros.grids import read_grid
from placegraph_ros.labeler import label
from placegraph_ros.settings import Settings

pytest.importorskip("rclpy")


class CostmapFilterInfo:
    """The fields of nav2_msgs/CostmapFilterInfo, and no others."""

    __slots__ = ("base", "filter_mask_topic", "header", "multiplier", "type")

    def __init__(self) -> None:
        self.header = SimpleNamespace(frame_id="", stamp=None)
        self.type, self.filter_mask_topic, self.base, self.multiplier = 0, "", 0.0, 0.0


def stand_in(monkeypatch: pytest.MonkeyPatch) -> None:
    module = ModuleType("nav2_msgs.msg")
    module.CostmapFilterInfo = CostmapFilterInfo  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "nav2_msgs", ModuleType("nav2_msgs"))
    monkeypatch.setitem(sys.modules, "nav2_msgs.msg", module)


class Recorder:
    """A node that keeps what it is asked to publish."""

    def __init__(self, topics: tuple[str, ...]) -> None:
        self._settings = SimpleNamespace(topics=topics)
        self._topics = {name: SimpleNamespace(topic_name=f"/placegraph/{name}") for name in topics}
        self.created: list[tuple[Any, str, Any]] = []
        self.notes: list[str] = []
        self.published: dict[str, Any] = {}

    def create_publisher(self, kind: Any, topic: str, qos: Any) -> Any:
        self.created.append((kind, topic, qos))
        return SimpleNamespace(publish=lambda message: self.published.__setitem__(topic, message))

    def get_logger(self) -> Any:
        return SimpleNamespace(info=self.notes.append)


def test_every_mask_has_its_info(monkeypatch: pytest.MonkeyPatch, home: pg.OccupancyGrid) -> None:
    from placegraph_ros.node import LATCHED, PlacegraphNode

    stand_in(monkeypatch)
    node: Any = Recorder(("keepout_mask", "speed_mask"))
    node._filters = PlacegraphNode._filter_publishers(node)
    assert [(kind, topic) for kind, topic, _ in node.created] == [
        (CostmapFilterInfo, "~/keepout_filter_info"),
        (CostmapFilterInfo, "~/speed_filter_info"),
    ]
    assert all(qos is LATCHED for *_, qos in node.created), "late servers ask for the last message"
    output = label(read_grid(map_message(home)), Settings(topics=("keepout_mask", "speed_mask")), pg.Session(), None)
    for kind in ("keepout", "speed"):
        PlacegraphNode._publish_filter(node, kind, output, "now")
        info, mask = node.published[f"~/{kind}_filter_info"], output.masks[kind]
        assert info.filter_mask_topic == f"/placegraph/{kind}_mask"
        assert (info.header.frame_id, info.header.stamp) == (mask.grid.frame_id, "now")
        assert (info.type, info.base, info.multiplier) == (mask.kind, mask.base, mask.multiplier)
    # Nav2's filters: 0 keepout, 1 speed in percent of the maximum.
    assert [node.published[f"~/{kind}_filter_info"].type for kind in ("keepout", "speed")] == [0, 1]


def test_without_nav2_it_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    from placegraph_ros.node import PlacegraphNode

    monkeypatch.setitem(sys.modules, "nav2_msgs.msg", None)
    node: Any = Recorder(("keepout_mask",))
    assert PlacegraphNode._filter_publishers(node) == {} and node.created == []
    assert "nav2_msgs is not installed" in node.notes[0]
    quiet: Any = Recorder(("labels",))
    assert PlacegraphNode._filter_publishers(quiet) == {} and quiet.notes == [], "nobody asked for masks"
