"""Parameters."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import yaml
from conftest import HERE

from placegraph_ros.settings import SettingError, Settings


def test_the_parameter_file_has_the_defaults() -> None:
    text = (HERE.parent / "config/placegraph.yaml").read_text()
    (node,) = yaml.safe_load(text).values()
    assert node["ros__parameters"] == Settings.defaults()


def test_defaults_can_be_and_ros_can_hold_them() -> None:
    assert Settings.read(Settings.defaults()) == Settings()
    for name, value in Settings.defaults().items():
        assert isinstance(value, (str, int, float, list)) and value != [], name
    assert Settings.AT_START_ONLY | Settings.RELABEL <= set(Settings.defaults())


@pytest.mark.parametrize(
    ("name", "value", "text"),
    [
        ("follow", "freeze", "live, frozen"),
        ("topics", ["labels", "regoins"], "regoins"),
        ("exports", ["nav3"], "nav2"),
        ("model", "/none/model.json", "/none/model.json"),
        ("edits", "/none", "absolute path"),
        ("previous", "/none", "no file"),
        ("masks", "/none", "no file"),
        ("min_interval_s", -1.0, "0 to 3600"),
        ("min_interval_s", float("nan"), "0 to 3600"),
        ("robot_radius_m", 1e9, "0 to 100"),
        ("threads", -1, "0 to 1024"),
        ("free_thresh", 0.7, "less than occupied_thresh"),
        ("border_margin_m", -0.1, "0 to 10"),
    ],
)
def test_what_cannot_be_is_named(name: str, value: Any, text: str) -> None:
    with pytest.raises(SettingError, match=text) as info:
        Settings.read({**Settings.defaults(), name: value})
    assert f"parameter {name}:" in str(info.value)


def test_an_empty_word_is_none(tmp_path: Path) -> None:
    settings = Settings.read({**Settings.defaults(), "exports": [""], "topics": ["labels", ""]})
    assert (settings.exports, settings.topics) == ((), ("labels",))
    assert settings.changed(Settings()) == {"exports", "topics"}
