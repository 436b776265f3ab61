#!/usr/bin/env python3
"""Opens exported files with the programs that read them, and compares them with one another.

usage: check_exports.py DIR...      exit status: 1 if a check failed

Every export is optional. Every format must put one doorway within a cell of where topology.json has it. Chromium is used where
installed; DOT is read by pydot, and by Graphviz where installed.
"""

import json
import math
import pathlib
import re
import shutil
import subprocess
import sys
import warnings

import geopandas
import jsonschema
import networkx
import numpy
import pydot
import report_probe
import tmap2_schema
import yaml
from mcap_ros2.reader import read_ros2_messages
from PIL import Image
from rosbags.highlevel import AnyReader
from shapely.geometry import LineString, Point, Polygon



class Skipped(Exception):
    """What a check needs is not there."""


class Folder:
    def __init__(self, path):
        self.path = path
        self.document = json.loads((path / "topology.json").read_text())
        self.truth = known_doorway(self.document)

    def file(self, pattern):
        found = sorted(self.path.glob(pattern))
        if not found:
            raise Skipped(f"no {pattern}")
        return found[0]

    def yaml(self, pattern):
        return yaml.safe_load(self.file(pattern).read_text())

    def near_truth(self, x, y):
        """The known doorway is within one cell of (x, y)."""
        if self.truth:
            distance = math.hypot(x - self.truth["x"], y - self.truth["y"])
            assert distance <= self.truth["cell_m"], f"the doorway is {distance:.3f} m off"


def known_doorway(document):
    """The first doorway with exactly two ways through it that meet in the middle between its jambs, or None."""
    cell_m = document["map"]["resolution_m"]
    routes = [(c, c["route"]["line"]) for c in document["connections"] if "route" in c]
    stations = [(c[end], line[at]) for c, line in routes for end, at in (("a", 0), ("b", -1))]
    for place in document["places"]:
        ends = [station for id, station in stations if id == place["id"]]
        if place["role"] != "doorway" or len(ends) != 2:
            continue
        ax, ay, bx, by = (jamb[axis] for jamb in place["doorway"]["jambs"] for axis in "xy")
        x, y = (ax + bx) / 2, (ay + by) / 2
        if math.hypot(x - ends[0]["x"], y - ends[0]["y"]) < cell_m:
            classes = list(dict.fromkeys(p["class"] for p in document["places"]))
            zone = classes.index(place["class"]) + 1
            truth = {"doorway": place["name"], "id": place["id"], "x": x, "y": y, "cell_m": cell_m, "zone": zone}
            return truth | {"centroid": place["centroid"]}
    return None


def frames(folder):
    if not folder.truth:
        raise Skipped("no doorway to compare the formats by")
    origin = folder.document["map"]["origin"]
    return f"{folder.truth['doorway']}, map origin {origin['x']:.2f}, {origin['y']:.2f}, turned by {origin['yaw_rad']:.2f}"


def nav2(folder):
    graph = json.loads(folder.file("route_graph.geojson").read_text())
    nodes, edges = {}, {}
    for feature in graph["features"]:
        properties = feature["properties"]
        assert type(properties.get("frame", "map")) is str
        assert all(math.isfinite(v) for v in numpy.ravel(feature["geometry"]["coordinates"]))
        numbers_are_floats(properties["metadata"])
        assert type(properties["id"]) is int and 0 <= properties["id"] < 2**31 - 1
        target = nodes if feature["geometry"]["type"] == "Point" else edges
        assert properties["id"] not in nodes and properties["id"] not in edges, f"id {properties['id']} twice"
        target[properties["id"]] = feature
    ways = {(e["properties"]["startid"], e["properties"]["endid"]) for e in edges.values()}
    assert ways and all(end in nodes for way in ways for end in way)
    assert all((b, a) in ways for a, b in ways), "edges are directed: every way needs one back"
    if folder.truth:
        doorway = nodes[folder.truth["id"]]
        assert doorway["properties"]["metadata"]["name"] == folder.truth["doorway"]
        folder.near_truth(*doorway["geometry"]["coordinates"])
    return f"{len(nodes)} nodes, {len(edges)} edges"


def numbers_are_floats(metadata):
    for key, value in metadata.items():
        assert value is not None and not isinstance(value, dict), key
        values = value if isinstance(value, list) else [value]
        for item in values:
            assert isinstance(item, (str, bool, float)), f"{key}: {item!r} is {type(item).__name__}"


def geojson(folder):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        frame = geopandas.read_file(folder.file("regions.geojson"))
    assert frame.crs is not None and frame.crs.to_epsg() == 3857, frame.crs
    assert frame.geometry.is_valid.all()
    error = ((frame.geometry.area - frame.area_m2).abs() / frame.area_m2).max()
    assert error < 1e-6, f"areas differ by {error:.1e}"
    if folder.truth:
        inside = frame[frame.contains(Point(folder.truth["x"], folder.truth["y"]))]
        assert list(inside.name) == [folder.truth["doorway"]], list(inside.name)
    return f"{len(frame)} places, {frame.geometry.area.sum():.2f} m2"


def graphml(folder):
    graph = networkx.read_graphml(folder.file("graph.graphml"))
    assert not graph.is_directed()
    for node, values in graph.nodes(data=True):
        assert isinstance(values["class"], str)
        for key in ("area_m2", "x", "y", "major_m", "minor_m", "probability"):
            assert isinstance(values[key], float), (node, key)
    if folder.truth:
        doorway = graph.nodes[str(folder.truth["id"])]
        assert doorway["name"] == folder.truth["doorway"]
        # Its coordinates are those of the centroid.
        x, y = (folder.truth[axis] + doorway[axis] - folder.truth["centroid"][axis] for axis in "xy")
        folder.near_truth(x, y)
    return f"{graph.number_of_nodes()} nodes, {graph.number_of_edges()} edges"


def dot(folder):
    file = folder.file("graph.dot")
    (drawn,) = pydot.graph_from_dot_file(str(file))
    nodes = {int(node.get_name()): node.get("class").strip('"') for node in drawn.get_nodes() if node.get_name().isdigit()}
    edges = {tuple(sorted((int(edge.get_source()), int(edge.get_destination())))) for edge in drawn.get_edges()}
    graph = networkx.read_graphml(folder.file("graph.graphml"))
    assert edges == {tuple(sorted((int(a), int(b)))) for a, b in graph.edges}
    assert nodes == {int(node): values["class"] for node, values in graph.nodes(data=True)}
    if folder.truth:
        (doorway,) = drawn.get_node(str(folder.truth["id"]))
        # 36 points a meter.
        folder.near_truth(*(float(v) / 36 for v in doorway.get("pos").strip('"!').split(",")))
    if shutil.which("dot"):
        subprocess.run(["dot", "-Tjson0", file], check=True, capture_output=True)
    return f"{len(nodes)} nodes, {len(edges)} edges"


def rmf_nav_graph(folder):
    graph = folder.yaml("nav_graph.yaml")
    (level,) = graph["levels"].values()
    names = [v[2]["name"] for v in level["vertices"] if v[2]["name"]]
    assert len(names) == len(set(names))
    for _, _, options in level["vertices"]:
        flags = ("is_charger", "is_holding_point", "is_parking_spot")
        assert isinstance(options["name"], str) and all(type(options[flag]) is bool for flag in flags)
    assert all(set(door) == {"endpoints", "map"} and door["map"] in graph["levels"] for door in graph["doors"].values())
    crossings = set()
    for start, end, options in level["lanes"]:
        assert start != end and max(start, end) < len(level["vertices"])
        ends = LineString([level["vertices"][index][:2] for index in (start, end)])
        crossed = [name for name, door in graph["doors"].items() if ends.crosses(LineString(door["endpoints"]))]
        # RMF's editor finds a lane's door by this rule when it makes a navigation graph of a building.
        assert options.get("door_name") in (crossed or [None]), (options, crossed)
        crossings.update(crossed)
    assert crossings == set(graph["doors"]), f"no lane through {set(graph['doors']) - crossings}"
    if folder.truth:
        (ax, ay), (bx, by) = graph["doors"][folder.truth["doorway"]]["endpoints"]
        folder.near_truth((ax + bx) / 2, (ay + by) / 2)
    return f"{len(level['vertices'])} vertices, {len(level['lanes'])} lanes, {len(graph['doors'])} doors"


def rmf_building(folder):
    building = folder.yaml("*.building.yaml")
    assert building["coordinate_system"] == "cartesian_meters"
    (level,) = building["levels"].values()
    kinds = {1: str, 2: int, 3: float, 4: bool}
    for first, second, parameters in level["lanes"] + level["doors"]:
        assert max(first, second) < len(level["vertices"])
        for kind, value in parameters.values():
            assert type(value) is kinds[kind], parameters
    if folder.truth:
        (door,) = [d for d in level["doors"] if d[2]["name"][1] == folder.truth["doorway"]]
        ends = [level["vertices"][i] for i in door[:2]]
        folder.near_truth(sum(e[0] for e in ends) / 2, sum(e[1] for e in ends) / 2)
        floors = [Polygon([level["vertices"][i][:2] for i in floor["vertices"]]) for floor in level["floors"]]
        assert any(floor.contains(Point(folder.truth["x"], folder.truth["y"])) for floor in floors)
    return f"{len(level['vertices'])} vertices, {len(level['doors'])} doors, {len(level['floors'])} floors"


def tmap2(folder):
    tmap = folder.yaml("*.tmap2.yaml")
    jsonschema.validate(tmap, tmap2_schema.TMAP)
    nodes = {entry["node"]["name"]: entry["node"] for entry in tmap["nodes"]}
    assert len(nodes) == len(tmap["nodes"])
    for node in nodes.values():
        assert all(edge["node"] in nodes for edge in node["edges"])
    if folder.truth:
        position = nodes[folder.truth["doorway"]]["pose"]["position"]
        folder.near_truth(position["x"], position["y"])
        corners = [(v["x"], v["y"]) for v in nodes[folder.truth["doorway"]]["verts"]]
        assert abs(numpy.mean([c[0] for c in corners])) < 1.0, "vertices are relative to the node"
    return f"{len(nodes)} nodes"


def mask(name):
    def check(folder):
        file = folder.yaml(f"{name}.yaml")
        image = numpy.asarray(Image.open(folder.path / file["image"]))
        assert file["mode"] == "raw" and len(file["origin"]) == 3 and file["origin"][2] == 0
        assert image.ndim == 2 and image.max() <= 100
        parameters = folder.yaml(f"{name}_params.yaml")
        short = {"zones": "zone_parameter"}.get(name, name)
        info = parameters[f"{short}_costmap_filter_info_server"]["ros__parameters"]
        assert type(info["base"]) is float and type(info["multiplier"]) is float
        if name == "zones":
            declared_zones(parameters, image)
        if folder.truth:
            column = int((folder.truth["x"] - file["origin"][0]) / file["resolution"])
            row = image.shape[0] - 1 - int((folder.truth["y"] - file["origin"][1]) / file["resolution"])
            expected = {"zones": folder.truth["zone"], "speed": 50, "keepout": 0}[name]
            assert image[row, column] == expected, (image[row, column], expected)
        return f"{image.shape[1]} x {image.shape[0]}, values {sorted(set(image.ravel().tolist()))[:6]}"

    return check


def filters(folder):
    """Every filter has servers of its own, the topics meet, and the launch file starts what the parameters name."""
    file = folder.yaml("nav2_filters.yaml")
    launch = (folder.path / "nav2_filters.launch.py").read_text()
    compile(launch, "nav2_filters.launch.py", "exec")
    masks = {}
    for line in launch.splitlines():
        if line.strip().startswith("'") and ".yaml" in line and ":" in line:
            name, mask_file = line.strip().rstrip(",").split(": ")
            masks[name.strip("'")] = mask_file.strip('"')
    costmap = file["global_costmap"]["global_costmap"]["ros__parameters"]
    assert costmap["filters"] == ["keepout_filter", "speed_filter"], costmap["filters"]
    assert file["local_costmap"]["local_costmap"]["ros__parameters"]["filters"] == ["keepout_filter"]
    assert list(masks) == ["keepout", "speed", "zone_parameter"], masks
    for name, mask_file in masks.items():
        server = file[f"{name}_filter_mask_server"]["ros__parameters"]
        info = file[f"{name}_costmap_filter_info_server"]["ros__parameters"]
        assert server["yaml_filename"] == mask_file and server["topic_name"] == info["mask_topic"]
        assert costmap[f"{name}_filter"]["filter_info_topic"] == info["filter_info_topic"]
        image = folder.yaml(mask_file)["image"]
        assert Image.open(folder.path / image).size[0] > 0
    return f"{len(masks)} filters"


def declared_zones(parameters, image):
    plugin = parameters["global_costmap"]["global_costmap"]["ros__parameters"]["zone_parameter_filter"]
    ids = {plugin[state]["id"] for state in plugin["states"]}
    assert set(image.ravel().tolist()) - {0} <= ids, "a value that is no declared state throws"


def shapes(folder):
    server = folder.yaml("shapes.yaml")["vector_object_server"]["ros__parameters"]
    for name in server["shapes"]:
        shape = server[name]
        assert shape["type"] == "polygon" and len(shape["points"]) >= 6 and len(shape["points"]) % 2 == 0
        assert all(type(v) is float for v in shape["points"])
        if folder.truth and name.startswith(f"place_{folder.truth['id']}_"):
            corners = numpy.reshape(shape["points"], (-1, 2))
            assert Polygon(corners).contains(Point(folder.truth["x"], folder.truth["y"]))
    return f"{len(server['shapes'])} shapes"


def svg(folder):
    text = folder.file("regions.svg").read_text()
    paths = dict(re.findall(r'<path id="place-(\d+)"[^>]* d="([^"]*)"', text))
    assert len(paths) == len(folder.document["places"])
    if folder.truth:
        origin, height = folder.document["map"]["origin"], float(re.search(r'viewBox="0 0 \S+ (\S+)"', text)[1])
        corners = [tuple(map(float, corner.split())) for corner in re.split("[MLZ]", paths[str(folder.truth["id"])]) if corner]
        # Drawn along the grid, 40 pixels a meter, with a margin of 20.
        grid = [((x - 20) / 40, (height - y - 20) / 40) for x, y in corners]
        cos, sin = math.cos(origin["yaw_rad"]), math.sin(origin["yaw_rad"])
        drawn = Polygon([(origin["x"] + u * cos - w * sin, origin["y"] + u * sin + w * cos) for u, w in grid])
        assert drawn.contains(Point(folder.truth["x"], folder.truth["y"]))
    return f"{len(paths)} places"


def report(folder):
    html = folder.file("report.html").read_text()
    for word in ("https://", "src=\"http", "@import"):
        assert word not in html, f"the page must not need the network: {word}"
    browser = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    if not browser:
        raise Skipped("no Chromium")
    probe = report_probe.run(browser, html, doorway=folder.truth["id"] if folder.truth else 0)
    assert "error" not in probe, probe["error"]
    assert probe["rows"] == probe["places"] > 0 and probe["free"] > 0, probe
    assert probe["hidden"] and probe["zoomed"] and probe["chosen"] and "probability" in probe["tip"], probe
    if folder.truth:
        assert folder.truth["doorway"] in probe["doorwayTip"], probe
        folder.near_truth(*map(float, re.match(r"(-?[\d.]+), (-?[\d.]+) m", probe["at"]).groups()))
    return f"{probe['rows']} places"


def recording(folder):
    path = folder.file("semantic_map.mcap")
    by_topic = {found.channel.topic: found for found in read_ros2_messages(str(path))}
    map = folder.document["map"]
    for topic in ("/map", "/placegraph/labels", "/placegraph/regions"):
        grid = by_topic[topic].ros_msg
        assert (grid.info.width, grid.info.height) == (map["width"], map["height"]), topic
        assert grid.header.frame_id == map["frame_id"] and abs(grid.info.resolution - map["resolution_m"]) < 1e-6
        position, turn = grid.info.origin.position, grid.info.origin.orientation
        yaw = 2 * math.atan2(turn.z, turn.w)
        assert math.isclose(position.x, map["origin"]["x"]) and math.isclose(position.y, map["origin"]["y"])
        assert math.isclose(yaw, map["origin"]["yaw_rad"], abs_tol=1e-9), yaw
    with Image.open(folder.file("regions.png")) as image:
        regions = numpy.asarray(image).astype(int)
    shape = regions.shape
    found = numpy.array(by_topic["/placegraph/regions"].ros_msg.data).reshape(shape)[::-1]
    numpy.testing.assert_array_equal(found, numpy.where(regions == 0, -1, (regions - 1) % 100 + 1))
    with Image.open(folder.file("labels.png")) as image:
        labels = numpy.asarray(image).astype(int)
    found = numpy.array(by_topic["/placegraph/labels"].ros_msg.data).reshape(shape)[::-1]
    numpy.testing.assert_array_equal(found, numpy.where(regions == 0, -1, labels))
    places = {place["id"]: place for place in folder.document["places"]}
    markers = by_topic["/placegraph/markers"].ros_msg.markers
    assert markers[0].action == 3 and all(marker.action == 0 for marker in markers[1:])
    names = {marker.id: marker.text for marker in markers if marker.ns == "names"}
    doors = {marker.id: marker for marker in markers if marker.ns == "doors"}
    assert names == {number: place["name"] for number, place in places.items() if "doorway" not in place}
    for number, marker in doors.items():
        jambs = places[number]["doorway"]["jambs"]
        assert [(p.x, p.y) for p in marker.points] == [(jamb["x"], jamb["y"]) for jamb in jambs]
        if folder.truth and places[number]["name"] == folder.truth["doorway"]:
            folder.near_truth(*(sum(jamb[axis] for jamb in jambs) / 2 for axis in "xy"))
    assert json.loads(by_topic["/placegraph/topology"].ros_msg.data)["places"] == folder.document["places"]
    with AnyReader([path]) as reader:
        latched = [connection.topic for connection in reader.connections if "transient_local" in str(connection.ext.offered_qos_profiles).lower()]
        assert sorted(latched) == sorted(by_topic), latched
        sizes = [reader.deserialize(raw, connection.msgtype) and connection.topic for connection, _, raw in reader.messages()]
    assert sorted(sizes) == sorted(by_topic)
    return f"{len(markers)} markers, {len(by_topic)} topics"


CHECKS = {
    "frames": frames,
    "Nav2 route graph": nav2,
    "GeoJSON in GeoPandas": geojson,
    "GraphML in NetworkX": graphml,
    "DOT": dot,
    "Open-RMF navigation graph": rmf_nav_graph,
    "Open-RMF building": rmf_building,
    "LCAS tmap2 against its schema": tmap2,
    "keep-out mask": mask("keepout"),
    "speed mask": mask("speed"),
    "zone mask": mask("zones"),
    "all masks": filters,
    "vector shapes": shapes,
    "recording in mcap-ros2-support and rosbags": recording,
    "SVG": svg,
    "report in Chromium": report,
}


def main(paths):
    failed = 0
    for path in paths:
        print(path)
        failed += run_checks(Folder(pathlib.Path(path)))
    if len(paths) > 1:
        print(f"{failed} checks failed in {len(paths)} folders")
    return failed


def run_checks(folder):
    failed = 0
    for name, check in CHECKS.items():
        try:
            print(f"ok    {name}: {check(folder)}")
        except Skipped as reason:
            print(f"skip  {name}: {reason}")
        except Exception as error:  # noqa: BLE001, one line per check, whatever goes wrong
            failed += 1
            print(f"FAIL  {name}: {type(error).__name__}: {error}")
    return failed


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]) > 0)
