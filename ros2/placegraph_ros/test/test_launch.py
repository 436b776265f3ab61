"""The launch file, read with stand-ins: there are no wheels of launch and launch_ros."""

from __future__ import annotations

import re
import runpy
import sys
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
import yaml

PACKAGE = Path(__file__).resolve().parents[1]


@dataclass(frozen=True)
class Argument:
    """launch.actions.DeclareLaunchArgument."""

    name: str
    default_value: str
    description: str


@dataclass(frozen=True)
class Configuration:
    """launch.substitutions.LaunchConfiguration."""

    name: str


@dataclass(frozen=True)
class Expression:
    """launch.substitutions.PythonExpression: a list of texts and configurations."""

    parts: list[Any]


@dataclass(frozen=True)
class If:
    """launch.conditions.IfCondition."""

    predicate: Any


class Node:
    """launch_ros.actions.Node, which takes these arguments and no others."""

    def __init__(
        self,
        *,
        package: str,
        executable: str,
        name: str | None = None,
        namespace: Any = None,
        parameters: Any = (),
        remappings: Any = (),
        arguments: Any = (),
        output: str = "log",
        condition: If | None = None,
    ) -> None:
        self.package, self.executable, self.name, self.namespace = package, executable, name, namespace
        self.parameters, self.remappings, self.arguments = list(parameters), list(remappings), list(arguments)
        self.output, self.condition = output, condition


@pytest.fixture
def description(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """What the launch file starts and declares."""

    def module(name: str, **content: Any) -> None:
        made = ModuleType(name)
        vars(made).update(content)
        monkeypatch.setitem(sys.modules, name, made)

    module("ament_index_python")
    module("ament_index_python.packages", get_package_share_directory=lambda name: {"placegraph_ros": str(PACKAGE)}[name])
    module("launch", LaunchDescription=list)
    module("launch.actions", DeclareLaunchArgument=Argument)
    module("launch.conditions", IfCondition=If)
    module("launch.substitutions", LaunchConfiguration=Configuration, PythonExpression=Expression)
    module("launch_ros")
    module("launch_ros.actions", Node=Node)
    found: list[Any] = runpy.run_path(str(PACKAGE / "launch/placegraph.launch.py"))["generate_launch_description"]()
    return found


def value(item: Any, given: dict[str, str]) -> Any:
    """What launch makes of a substitution."""
    if isinstance(item, Configuration):
        return given[item.name]
    if isinstance(item, Expression):
        return str(eval("".join(value(part, given) for part in item.parts)))  # as PythonExpression does
    return item


def started(description: list[Any], **given: str) -> dict[str, Node]:
    """The nodes that are started with these arguments."""
    arguments = {item.name: item.default_value for item in description if isinstance(item, Argument)}
    assert given.keys() <= arguments.keys()
    chosen = arguments | given
    # IfCondition takes the texts of true and false.
    truth = {"true": True, "True": True, "1": True, "false": False, "False": False, "0": False}
    nodes = [item for item in description if isinstance(item, Node)]
    running = [n for n in nodes if n.condition is None or truth[value(n.condition.predicate, chosen)]]
    for node in running:
        node.parameters = [
            {key: value(v, chosen) for key, v in p.items()} if isinstance(p, dict) else value(p, chosen) for p in node.parameters
        ]
        node.remappings = [(name, value(to, chosen)) for name, to in node.remappings]
    return {node.executable: node for node in running}


def test_the_node_starts_alone_with_its_parameters(description: list[Any]) -> None:
    nodes = started(description)
    assert list(nodes) == ["placegraph"]
    node = nodes["placegraph"]
    # What setup.py installs under this name, and the parameters of a node of this name.
    entry = re.search(r'console_scripts": \[f"(\w+) = ', (PACKAGE / "setup.py").read_text())
    assert entry is not None and entry[1] == node.executable and node.package == "placegraph_ros"
    parameters = yaml.safe_load(Path(node.parameters[0]).read_text())
    assert list(parameters) == [f"/**/{node.name}"]
    assert node.remappings == [("map", "map"), ("pose", "pose")]


def test_a_map_file_starts_nav2s_server_and_its_manager(description: list[Any]) -> None:
    nodes = started(description, map_file="/maps/office.yaml", map="floor")
    assert set(nodes) == {"placegraph", "map_server", "lifecycle_manager"}
    assert nodes["map_server"].parameters == [{"yaml_filename": "/maps/office.yaml", "topic_name": "floor"}]
    assert nodes["map_server"].name in nodes["lifecycle_manager"].parameters[0]["node_names"]
    assert ("map", "floor") in nodes["placegraph"].remappings


def test_rviz_gets_the_configuration_that_is_installed(description: list[Any]) -> None:
    rviz = started(description, rviz="true")["rviz2"]
    assert rviz.arguments[0] == "-d" and Path(rviz.arguments[1]).is_file()
    installed = (PACKAGE / "setup.py").read_text()
    for used in [Path(rviz.arguments[1]).name, "placegraph.yaml", "placegraph.launch.py"]:
        assert used in installed, used


def test_every_argument_is_used(description: list[Any]) -> None:
    text = (PACKAGE / "launch/placegraph.launch.py").read_text()
    for argument in (item for item in description if isinstance(item, Argument)):
        assert argument.description and text.count(f'LaunchConfiguration("{argument.name}")') > 0, argument.name
