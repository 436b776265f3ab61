"""The node ``placegraph``."""

from __future__ import annotations

import json
import sys
from typing import Any

import placegraph as pg
import rclpy
from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import PointStamped, PoseWithCovarianceStamped
from nav_msgs.msg import OccupancyGrid
from rcl_interfaces.msg import ParameterDescriptor, SetParametersResult
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.parameter import Parameter
from sensor_msgs.msg import Image
from std_msgs.msg import String
from std_srvs.srv import Trigger
from visualization_msgs.msg import MarkerArray

from .convert import LATCHED, grid_message, marker_message, region_message, status_message
from .grids import GridData, apply_update, read_grid
from .labeler import Labeler, Output
from .markers import markers
from .places import CurrentPlace, describe, describe_place
from .settings import SettingError, Settings
from .transforms import follow_frame

TYPES: dict[str, type] = {
    "labels": OccupancyGrid,
    "regions": OccupancyGrid,
    "region_image": Image,
    "markers": MarkerArray,
    "topology": String,
    "route_graph": String,
    "keepout_mask": OccupancyGrid,
    "speed_mask": OccupancyGrid,
}


class PlacegraphNode(Node):  # type: ignore[misc]  # rclpy has no types
    """Labels the map on ``map`` and publishes what comes of it. docs/ros2.md lists topics and parameters."""

    def __init__(self) -> None:
        super().__init__("placegraph")
        for name, default in Settings.defaults().items():
            read_only = name in Settings.AT_START_ONLY
            self.declare_parameter(name, default, ParameterDescriptor(read_only=read_only))
        self._settings = Settings.read(self._parameter_values())
        self._grid: GridData | None = None
        self._output: Output | None = None
        self._n_results = 0
        self._current = CurrentPlace(self._settings.border_margin_m)

        latched = [("status", DiagnosticArray), ("current_place", String)]
        latched += [(name, TYPES[name]) for name in self._settings.topics]
        self._topics = {name: self.create_publisher(kind, f"~/{name}", LATCHED) for name, kind in latched}
        self._place = self.create_publisher(String, "~/place", 10)
        self._filters = self._filter_publishers()
        self._report(DiagnosticStatus.OK, f"waiting for a map on {self.resolve_topic_name('map')}", {})

        # Results come from the labeler's thread; what they change is changed by the executor's.
        self._labeler = Labeler(self._settings, self._publish, self._refuse)
        self._subscribe()
        self.add_on_set_parameters_callback(self._on_parameters)
        self.create_service(Trigger, "~/save", self._on_save)

    def destroy_node(self) -> None:
        """Ends the labeler and the node."""
        self._labeler.close()
        super().destroy_node()

    def _parameter_values(self) -> dict[str, Any]:
        return {name: self.get_parameter(name).value for name in Settings.defaults()}

    def _subscribe(self) -> None:
        self.create_subscription(OccupancyGrid, "map", self._on_map, LATCHED)
        self.create_subscription(PointStamped, "~/clicked_point", self._on_click, 10)
        self.create_subscription(PoseWithCovarianceStamped, "pose", self._on_pose, 10)
        try:
            from map_msgs.msg import OccupancyGridUpdate
        except ImportError:
            self.get_logger().info("map_msgs is not installed: updates of the map are not read")
        else:
            self.create_subscription(OccupancyGridUpdate, "map_updates", self._on_update, 10)
        if self._settings.base_frame:
            if not follow_frame(self, self._settings.base_frame, self._map_frame, self._move_to):
                self.get_logger().warning("tf2_ros is not installed: base_frame has no effect, send poses on `pose`")

    def _map_frame(self) -> str | None:
        return None if self._output is None else self._output.grid.frame_id

    # Maps

    def _on_map(self, message: OccupancyGrid) -> None:
        try:
            self._grid = read_grid(message)
        except pg.Error as error:
            self._refuse(str(error))
            return
        self._labeler.submit(self._grid)

    def _on_update(self, message: Any) -> None:
        if self._grid is None:
            return  # an update of a map that we do not have
        try:
            self._grid = apply_update(self._grid, message)
        except pg.Error as error:
            self._refuse(str(error))
            return
        self._labeler.submit(self._grid)

    def _refuse(self, text: str) -> None:
        self.get_logger().error(text)
        self._report(DiagnosticStatus.ERROR, text, {})

    def _publish(self, output: Output) -> None:
        stamp = self._now()
        grid, topology = output.grid, output.result.topology
        colors = {
            each.name: (each.color[0] / 255, each.color[1] / 255, each.color[2] / 255)
            for each in output.result.classes
        }
        made: dict[str, Any] = {
            "labels": output.labels and grid_message(output.labels, stamp),
            "regions": output.regions and grid_message(output.regions, stamp),
            "topology": String(data=topology.to_json()),
            "route_graph": output.route_graph and String(data=output.route_graph),
        }
        if output.region_image is not None:
            made["region_image"] = region_message(output.region_image, grid.frame_id, stamp)
        if "markers" in self._topics:
            made["markers"] = marker_message(markers(topology, colors), grid.frame_id, stamp)
        for kind, mask in output.masks.items():
            made[f"{kind}_mask"] = grid_message(mask.grid, stamp)
            if kind in self._filters:
                self._publish_filter(kind, output, stamp)
        for name, message in made.items():
            if message is not None and name in self._topics:
                self._topics[name].publish(message)
        self._output = output
        self._n_results += 1
        self._report_output(output)

    def _report_output(self, output: Output) -> None:
        topology = output.result.topology
        counts = [(each.name, sum(place.class_name == each.name for place in topology)) for each in output.result.classes]
        height, width = output.grid.cells.shape
        values = {
            **{f"places of class {name}": n for name, n in counts},
            "map": f"{width} x {height} cells of {output.grid.resolution:g} m",
            "time": f"{output.elapsed_s:.2f} s",
            "results since start": self._n_results,
            **{f"finding {k}": text for k, text in enumerate(topology.document.get("findings", ()), 1)},
            **{f"left out {k}": text for k, text in enumerate(output.remarks, 1)},
        }
        problems = (*output.warnings, *output.remarks)
        text = ", ".join(f"{n} {name}" for name, n in counts)
        for problem in problems:
            self.get_logger().warning(problem)
        self.get_logger().info(f"{text} in {output.elapsed_s:.2f} s")
        level = DiagnosticStatus.WARN if problems else DiagnosticStatus.OK
        self._report(level, f"{text}; {problems[0]}" if problems else text, values)

    def _report(self, level: bytes, text: str, values: dict[str, Any]) -> None:
        name = f"{self.get_fully_qualified_name().strip('/')}: semantic map"
        self._topics["status"].publish(status_message(name, level, text, values, self._now()))

    def _now(self) -> Time:
        return self.get_clock().now().to_msg()

    # Costmap filters of Nav2

    def _filter_publishers(self) -> dict[str, Any]:
        kinds = [kind for kind in ("keepout", "speed") if f"{kind}_mask" in self._settings.topics]
        try:
            from nav2_msgs.msg import CostmapFilterInfo
        except ImportError:
            if kinds:
                self.get_logger().info("nav2_msgs is not installed: masks are published without CostmapFilterInfo")
            return {}
        return {kind: self.create_publisher(CostmapFilterInfo, f"~/{kind}_filter_info", LATCHED) for kind in kinds}

    def _publish_filter(self, kind: str, output: Output, stamp: Time) -> None:
        from nav2_msgs.msg import CostmapFilterInfo

        mask, info = output.masks[kind], CostmapFilterInfo()
        info.header.frame_id, info.header.stamp = mask.grid.frame_id, stamp
        info.type, info.base, info.multiplier = mask.kind, mask.base, mask.multiplier
        info.filter_mask_topic = self._topics[f"{kind}_mask"].topic_name
        self._filters[kind].publish(info)

    # Questions

    def _on_click(self, message: PointStamped) -> None:
        output = self._output
        if output is None:
            answer: dict[str, Any] = {"error": "there is no map yet"}
        elif message.header.frame_id not in ("", output.grid.frame_id):
            answer = {"error": f"expected a point in {output.grid.frame_id!r}, found {message.header.frame_id!r}"}
        else:
            answer = describe(output.result.topology, message.point.x, message.point.y, output.grid.frame_id)
        self._place.publish(String(data=json.dumps(answer, ensure_ascii=False)))

    def _on_pose(self, message: PoseWithCovarianceStamped) -> None:
        frame_id = message.header.frame_id
        if frame_id in ("", self._map_frame()):
            self._move_to(message.pose.pose.position.x, message.pose.pose.position.y)
        elif self._output is not None:
            text = f"poses in {frame_id!r} are not used: the map is in {self._map_frame()!r}"
            self.get_logger().warning(text, throttle_duration_sec=30.0)

    def _move_to(self, x: float, y: float) -> None:
        output = self._output
        if output is None:
            return
        topology = output.result.topology
        place, is_other = self._current.move_to(topology, x, y)
        if is_other:
            facts = None if place is None else describe_place(topology, place)
            answer = {"frame_id": output.grid.frame_id, "x": x, "y": y, "place": facts}
            self._topics["current_place"].publish(String(data=json.dumps(answer, ensure_ascii=False)))

    # Commands

    def _on_save(self, _request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        folder = self._settings.output_folder
        if self._output is None:
            response.message = "there is no map yet"
        elif not folder:
            response.message = "set the parameter output_folder first"
        else:
            try:
                files = self._output.result.save(
                    folder, export=self._settings.exports, masks=self._settings.masks or None
                )
            except (pg.Error, OSError) as error:
                response.message = str(error)
            else:
                response.success = True
                response.message = f"{len(files)} files in {folder}"
        return response

    def _on_parameters(self, parameters: list[Parameter]) -> SetParametersResult:
        ours = {each.name: each.value for each in parameters if each.name in Settings.defaults()}
        try:
            settings = Settings.read({**self._parameter_values(), **ours})
            self._labeler.change(settings)
        except (SettingError, TypeError, pg.Error) as error:
            return SetParametersResult(successful=False, reason=str(error))
        self._settings = settings
        self._current.margin_m = settings.border_margin_m
        return SetParametersResult(successful=True)


def main(args: list[str] | None = None) -> int:
    """Runs the node until it is asked to stop."""
    rclpy.init(args=args)
    try:
        node = PlacegraphNode()
    except (SettingError, pg.Error) as error:
        print(f"placegraph: {error}", file=sys.stderr)
        rclpy.try_shutdown()
        return 2
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
    return 0


if __name__ == "__main__":
    sys.exit(main())
