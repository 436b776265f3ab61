"""The node and real ROS 2, in a network namespace: `.ci/run ros`. Bytes are those of the program's files."""

from __future__ import annotations

import array
import functools
import hashlib
import json
import math
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import placegraph as pg
import pytest
import yaml
from conftest import HERE, ROOT
from PIL import Image

rclpy = pytest.importorskip("rclpy")
if not os.environ.get("PLACEGRAPH_ROS_ALONE"):
    pytest.skip("nodes announce themselves on every network: run .ci/run ros", allow_module_level=True)

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus  # noqa: E402
from geometry_msgs.msg import PointStamped, PoseWithCovarianceStamped  # noqa: E402
from nav_msgs.msg import OccupancyGrid  # noqa: E402
from rcl_interfaces.msg import Parameter, ParameterValue  # noqa: E402
from rcl_interfaces.srv import SetParameters  # noqa: E402
from rclpy.serialization import deserialize_message, serialize_message  # noqa: E402
from std_msgs.msg import String  # noqa: E402
from std_srvs.srv import Trigger  # noqa: E402

from placegraph_ros.convert import LATCHED, marker_message  # noqa: E402
from placegraph_ros.markers import markers  # noqa: E402
from placegraph_ros.node import TYPES  # noqa: E402

TIMEOUT_S = 300.0
PROGRAM = os.environ.get("PLACEGRAPH_PROGRAM")


class Peer:
    """A node of the tests, and what it received."""

    def __init__(self, name: str = "peer") -> None:
        self.node = rclpy.create_node(name)
        self.map = self.node.create_publisher(OccupancyGrid, "map", LATCHED)
        self.received: dict[str, list[Any]] = {}

    def listen(self, kind: type, topic: str) -> None:
        found = self.received.setdefault(topic, [])
        self.node.create_subscription(kind, topic, found.append, LATCHED)

    def wait(self, what: Callable[[], Any], timeout_s: float = TIMEOUT_S) -> Any:
        """Spins until `what` is true, and returns it."""
        end = time.monotonic() + timeout_s
        while time.monotonic() < end:
            rclpy.spin_once(self.node, timeout_sec=0.05)
            if found := what():
                return found
        raise AssertionError("nothing came in time; statuses: " + str([s.message for s in self.statuses()]))

    def statuses(self) -> list[DiagnosticStatus]:
        return [message.status[0] for message in self.received.get("/placegraph/status", [])]

    def wait_for_result(self, n: int) -> DiagnosticStatus:
        """The status of the n-th result since the node was started."""
        wanted = {"results since start": str(n)}.items()
        values = lambda status: {pair.key: pair.value for pair in status.values}.items()  # noqa: E731
        return self.wait(lambda: next((s for s in self.statuses() if wanted <= values(s)), None))

    def call(self, kind: type, service: str, request: Any) -> Any:
        client = self.node.create_client(kind, service)
        assert client.wait_for_service(30.0)
        future = client.call_async(request)
        self.wait(future.done)
        return future.result()


@pytest.fixture(scope="module", autouse=True)
def _ros() -> Iterator[None]:
    rclpy.init()
    yield
    rclpy.shutdown()


@pytest.fixture
def peer() -> Iterator[Peer]:
    made = Peer()
    made.listen(DiagnosticArray, "/placegraph/status")
    yield made
    made.node.destroy_node()


Start = Callable[..., "subprocess.Popen[str]"]


@pytest.fixture
def start(tmp_path: Path) -> Iterator[Start]:
    """Starts the node with parameters."""
    running: list[subprocess.Popen[str]] = []

    def run(**parameters: Any) -> subprocess.Popen[str]:
        file = tmp_path / f"parameters{len(running)}.yaml"
        file.write_text(yaml.safe_dump({"/placegraph": {"ros__parameters": {"min_interval_s": 0.0, **parameters}}}))
        environment = {**os.environ, "PYTHONPATH": f"{HERE.parent}:{os.environ.get('PYTHONPATH', '')}"}
        command = [sys.executable, "-m", "placegraph_ros.node", "--ros-args", "--params-file", str(file)]
        running.append(subprocess.Popen(command, env=environment, stderr=subprocess.PIPE, text=True))
        return running[-1]

    yield run
    for process in running:
        stop(process)


def stop(process: subprocess.Popen[str]) -> None:
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
        try:
            process.communicate(timeout=60)
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()


def message_of(map: pg.OccupancyGrid) -> OccupancyGrid:
    message = OccupancyGrid()
    message.header.frame_id = "map"
    message.info.resolution = map.resolution
    message.info.height, message.info.width = map.shape
    x, y, yaw = map.origin
    message.info.origin.position.x, message.info.origin.position.y = x, y
    message.info.origin.orientation.z, message.info.origin.orientation.w = math.sin(yaw / 2), math.cos(yaw / 2)
    message.data = array.array("b", map.array[::-1].tobytes())
    return message


def maps() -> dict[str, Path]:
    """The example maps, a turned one, and with PLACEGRAPH_DATA a real building."""
    found = {"office": ROOT / "maps/office/map.yaml", "home": ROOT / "maps/home/map.yaml"}
    if data := os.environ.get("PLACEGRAPH_DATA"):
        found["fr79"] = Path(data, "eval/fr79_slam/map.yaml")
    return found


@pytest.fixture(scope="session")
def turned(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The home, turned by 0.6 rad with its origin elsewhere."""
    folder = tmp_path_factory.mktemp("turned")
    (folder / "map.png").write_bytes((ROOT / "maps/home/map.png").read_bytes())
    lines = (ROOT / "maps/home/map.yaml").read_text().splitlines()
    lines = ["origin: [-7.31, 12.84, 0.6]" if line.startswith("origin:") else line for line in lines]
    (folder / "map.yaml").write_text("\n".join(lines) + "\n")
    return folder / "map.yaml"


def pixels(path: Path) -> Any:
    with Image.open(path) as image:
        return np.asarray(image).copy()


def cells(message: OccupancyGrid) -> Any:
    """The values of a grid with row 0 at the top."""
    return np.array(message.data, np.int8).reshape(message.info.height, message.info.width)[::-1]


def comparable(document: dict[str, Any]) -> dict[str, Any]:
    """A document without what says where the map came from, and which files were written."""
    left = {key: value for key, value in document.items() if key not in ("files", "sha256", "timings_ms", "skipped", "program")}
    left["map"] = {key: value for key, value in left["map"].items() if key not in ("hash", "sha256", "name")}
    return left


@pytest.mark.skipif(PROGRAM is None, reason="PLACEGRAPH_PROGRAM does not name the program")
@pytest.mark.parametrize("name", [*maps(), "turned"])
def test_a_late_joiner_has_the_programs_bytes(name: str, peer: Peer, start: Start, turned: Path, tmp_path: Path) -> None:
    path = {**maps(), "turned": turned}[name]
    masks = tmp_path / "masks.toml"
    masks.write_text('rotated = "resample"\n')
    files = tmp_path / "files"
    command = [str(PROGRAM), "map", str(path), "--out", str(files), "--export", "nav2,nav2-keepout,nav2-speed"]
    done = subprocess.run([*command, "--masks", str(masks)], capture_output=True, text=True, check=False)
    assert done.returncode in (0, 1), done.stderr
    map = pg.load_map(path)
    peer.map.publish(message_of(map))
    start(masks=str(masks), map_name=map.name)
    peer.wait_for_result(1)

    late = Peer("late")
    for topic, kind in TYPES.items():
        late.listen(kind, f"/placegraph/{topic}")
    try:
        late.wait(lambda: all(late.received.values()), 60.0)
    finally:
        late.node.destroy_node()
    got = {topic: late.received[f"/placegraph/{topic}"][-1] for topic in TYPES}

    labels, regions = pixels(files / "labels.png"), pixels(files / "regions.png")
    np.testing.assert_array_equal(cells(got["labels"]), np.where(labels == 0, -1, labels.astype(int)))
    image = got["region_image"]
    numbers = np.frombuffer(image.data, "<i4").reshape(image.height, image.width)
    np.testing.assert_array_equal(numbers, regions)
    np.testing.assert_array_equal(cells(got["regions"]), np.where(regions == 0, -1, (regions.astype(int) - 1) % 100 + 1))
    # The stamp has the hash of the map: of the file there, of the message here.
    unstamped = functools.partial(re.sub, rb"map sha256:\w+", b"")
    assert unstamped(got["route_graph"].data.encode()) == unstamped((files / "route_graph.geojson").read_bytes())
    ours, theirs = json.loads(got["topology"].data), json.loads((files / "topology.json").read_text())
    assert comparable(ours) == comparable(theirs)
    for kind in ("keepout", "speed"):
        mask = pixels(files / f"{kind}.png")
        np.testing.assert_array_equal(cells(got[f"{kind}_mask"]), np.where(mask > 100, -1, mask.astype(int)))
        origin = yaml.safe_load((files / f"{kind}.yaml").read_text())["origin"]
        position = got[f"{kind}_mask"].info.origin.position
        assert [position.x, position.y] == pytest.approx(origin[:2], abs=1e-9)
    origin, sent = got["labels"].info.origin, message_of(map).info.origin
    assert (origin.position.x, origin.position.y) == (sent.position.x, sent.position.y)
    assert origin.orientation.z == pytest.approx(sent.orientation.z, abs=1e-12)
    topology = pg.Topology.load(files / "topology.json")
    colors = {each["name"]: tuple(value / 255 for value in each["color"]) for each in theirs["classes"]}
    stamp = got["markers"].markers[0].header.stamp
    # As it arrives: in Python a color has more digits than in the message, and the bytes between fields may be any.
    expected = marker_message(markers(topology, colors), "map", stamp)
    assert got["markers"] == deserialize_message(serialize_message(expected), type(expected))


def test_the_node_can_be_restarted(peer: Peer, start: Start) -> None:
    peer.map.publish(message_of(pg.load_map(ROOT / "maps/home/map.yaml")))
    peer.listen(OccupancyGrid, "/placegraph/labels")
    first = start()
    peer.wait_for_result(1)
    peer.wait(lambda: len(peer.received["/placegraph/labels"]) == 1)
    stop(first)
    assert first.returncode == 0
    start()
    before, after = peer.wait(lambda: peer.received["/placegraph/labels"][:2] if len(peer.received["/placegraph/labels"]) > 1 else None)
    assert before.data == after.data


def test_bad_maps_are_told_and_the_node_lives(peer: Peer, start: Start) -> None:
    process = start()
    good = message_of(pg.load_map(ROOT / "maps/home/map.yaml"))
    nothing, no_resolution, cut, wall = OccupancyGrid(), message_of(pg.load_map(ROOT / "maps/home/map.yaml")), OccupancyGrid(), OccupancyGrid()
    no_resolution.info.resolution = 0.0
    cut.info.width, cut.info.height, cut.info.resolution = 9, 9, 0.05
    wall.info.width, wall.info.height, wall.info.resolution = 2, 2, 0.05
    wall.data = array.array("b", [100] * 4)
    peer.wait(peer.statuses)
    for message, text in [(nothing, "no cells"), (no_resolution, "resolution"), (cut, "expected 9 x 9"), (wall, "free")]:
        n = len(peer.statuses())
        peer.map.publish(message)
        status = peer.wait(lambda: peer.statuses()[n:])[-1]
        assert status.level == DiagnosticStatus.ERROR and text in status.message
    peer.map.publish(good)
    status = peer.wait_for_result(1)
    assert status.level != DiagnosticStatus.ERROR and process.poll() is None


def test_sixteen_million_cells(peer: Peer, start: Start) -> None:
    office = pg.load_map(ROOT / "maps/office/map.yaml")
    large = np.full((4000, 4000), -1, np.int8)
    height, width = office.shape
    large[1500 : 1500 + height, 2000 : 2000 + width] = office.array
    map = pg.OccupancyGrid(large, resolution=office.resolution, origin=(-100.0, -100.0, 0.0))
    peer.listen(OccupancyGrid, "/placegraph/labels")
    start()
    peer.map.publish(message_of(map))
    peer.wait_for_result(1)
    (labels,) = peer.wait(lambda: peer.received["/placegraph/labels"])
    wanted = pg.label(map).labels.astype(int)
    np.testing.assert_array_equal(cells(labels), np.where(wanted == 0, -1, wanted))


def test_questions_and_commands(peer: Peer, start: Start, tmp_path: Path) -> None:
    home = pg.load_map(ROOT / "maps/home/map.yaml")
    topology = pg.label(home).topology
    doorway = next(each for each in topology.doorways if len(each.side_ids) == 2)
    answers: list[dict[str, Any]] = []
    peer.node.create_subscription(String, "/placegraph/place", lambda message: answers.append(json.loads(message.data)), 10)
    click = peer.node.create_publisher(PointStamped, "/placegraph/clicked_point", 10)
    poses = peer.node.create_publisher(PoseWithCovarianceStamped, "pose", 10)
    peer.listen(String, "/placegraph/current_place")
    start()
    saved = peer.call(Trigger, "/placegraph/save", Trigger.Request())
    assert not saved.success and "no map" in saved.message
    peer.map.publish(message_of(home))
    peer.wait_for_result(1)

    point = PointStamped()
    point.header.frame_id = "map"
    point.point.x, point.point.y = doorway.anchor
    peer.wait(lambda: click.get_subscription_count() and poses.get_subscription_count())
    click.publish(point)
    peer.wait(lambda: answers)
    assert answers[-1]["place"]["name"] == doorway.name and len(answers[-1]["place"]["sides"]) == 2
    point.header.frame_id = "odom"
    click.publish(point)
    peer.wait(lambda: len(answers) == 2)
    assert "odom" in answers[-1]["error"]

    # A latched topic keeps only its last message, so each is awaited before the next is caused.
    found = peer.received["/placegraph/current_place"]
    first, second = (topology[id] for id in doorway.side_ids)
    for n, place in [(1, first), (1, first), (2, second)]:
        pose = PoseWithCovarianceStamped()
        pose.header.frame_id = "map"
        pose.pose.pose.position.x, pose.pose.pose.position.y = place.anchor
        poses.publish(pose)
        peer.wait(lambda n=n: len(found) == n)
    assert [json.loads(message.data)["place"]["id"] for message in found] == list(doorway.side_ids)

    saved = peer.call(Trigger, "/placegraph/save", Trigger.Request())
    assert not saved.success and "output_folder" in saved.message
    answer = change(peer, output_folder=str(tmp_path / "out"))
    assert answer.successful, answer.reason
    saved = peer.call(Trigger, "/placegraph/save", Trigger.Request())
    assert saved.success, saved.message
    assert pg.Topology.load(tmp_path / "out/topology.json").places == topology.places
    assert (tmp_path / "out/route_graph.geojson").exists()


def change(peer: Peer, **values: str) -> Any:
    """Sets parameters of type string."""
    request = SetParameters.Request()
    request.parameters = [
        Parameter(name=name, value=ParameterValue(type=4, string_value=value)) for name, value in values.items()
    ]
    return peer.call(SetParameters, "/placegraph/set_parameters", request).results[0]


def test_parameters_while_it_runs(peer: Peer, start: Start, tmp_path: Path) -> None:
    home = pg.load_map(ROOT / "maps/home/map.yaml")
    peer.listen(String, "/placegraph/topology")
    peer.map.publish(message_of(home))
    start()
    peer.wait_for_result(1)
    documents = peer.received["/placegraph/topology"]
    peer.wait(lambda: len(documents) == 1)
    for name, value, text in [
        ("follow", "freeze", "live, frozen"),
        ("edits", "/none", "no file"),
        ("map_name", "other", "read"),
    ]:
        answer = change(peer, **{name: value})
        assert not answer.successful and text in answer.reason
    place = pg.label(home).places[0]
    edits = tmp_path / "edits.toml"
    edits.write_text(f'[[edit]]\naction = "rename"\nat = [{place.anchor[0]}, {place.anchor[1]}]\nname = "den"\n')
    assert change(peer, edits=str(edits)).successful
    peer.wait_for_result(2)
    peer.wait(lambda: len(documents) == 2)
    assert pg.Topology(documents[-1].data)["den"].id == place.id


def test_parameters_that_cannot_be_end_it_at_once(start: Start, tmp_path: Path) -> None:
    broken = tmp_path / "broken.json"
    broken.write_text("{}")
    for parameters, text in [({"model": "/none.json"}, "parameter model"), ({"model": str(broken)}, "model"), ({"follow": "x"}, "parameter follow")]:
        process = start(**parameters)
        _, errors = process.communicate(timeout=60)
        assert process.returncode == 2 and text in errors, errors
        assert "Traceback" not in errors


def test_cyclone_reads_the_labels(peer: Peer, start: Start) -> None:
    pytest.importorskip("cyclonedds")
    home = pg.load_map(ROOT / "maps/home/map.yaml")
    peer.listen(OccupancyGrid, "/placegraph/labels")
    peer.map.publish(message_of(home))
    start()
    peer.wait_for_result(1)
    (labels,) = peer.wait(lambda: peer.received["/placegraph/labels"])
    command = [sys.executable, str(HERE / "cyclone_reader.py"), "/placegraph/labels", "60"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    digest = hashlib.sha256(labels.data.tobytes()).hexdigest()
    assert done.stdout.split() == [str(labels.info.width), str(labels.info.height), "map", digest]
