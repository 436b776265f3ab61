"""Plain data as messages of ROS."""

from __future__ import annotations

import array
import math
from typing import Any

import numpy as np
from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from geometry_msgs.msg import Point
from nav_msgs.msg import OccupancyGrid
from numpy.typing import NDArray
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import Image
from visualization_msgs.msg import Marker as MarkerMessage
from visualization_msgs.msg import MarkerArray

from .grids import GridData
from .markers import Marker

LATCHED = QoSProfile(
    depth=1,
    history=HistoryPolicy.KEEP_LAST,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.TRANSIENT_LOCAL,
)
"""What map servers offer and readers of masks ask for: who comes late gets the last message."""


def grid_message(grid: GridData, stamp: Time) -> OccupancyGrid:
    """A ``nav_msgs/OccupancyGrid``."""
    message = OccupancyGrid()
    message.header.frame_id, message.header.stamp = grid.frame_id, stamp
    info = message.info
    info.map_load_time = stamp
    info.resolution = grid.resolution
    info.height, info.width = grid.cells.shape
    x, y, yaw = grid.origin
    info.origin.position.x, info.origin.position.y = x, y
    info.origin.orientation.z, info.origin.orientation.w = math.sin(yaw / 2), math.cos(yaw / 2)
    # rclpy takes an array without looking at every element.
    message.data = array.array("b", grid.cells.tobytes())
    return message


def region_message(regions: NDArray[np.uint32], frame_id: str, stamp: Time) -> Image:
    """A ``sensor_msgs/Image`` of the encoding 32SC1, row 0 at the top of the map."""
    message = Image()
    message.header.frame_id, message.header.stamp = frame_id, stamp
    message.height, message.width = regions.shape
    message.encoding, message.is_bigendian, message.step = "32SC1", 0, 4 * message.width
    message.data = array.array("B", regions.astype("<i4").tobytes())
    return message


def marker_message(markers: list[Marker], frame_id: str, stamp: Time) -> MarkerArray:
    """A ``visualization_msgs/MarkerArray``."""
    return MarkerArray(markers=[_marker(marker, frame_id, stamp) for marker in markers])


def _marker(marker: Marker, frame_id: str, stamp: Time) -> MarkerMessage:
    message = MarkerMessage()
    message.header.frame_id, message.header.stamp = frame_id, stamp
    message.ns, message.id = marker.namespace, marker.id
    message.type, message.action = int(marker.kind), int(marker.action)
    message.pose.position = _point(marker.position)
    message.pose.orientation.w = 1.0
    message.scale.x, message.scale.y, message.scale.z = marker.scale
    message.color.r, message.color.g, message.color.b = marker.color
    message.color.a = 1.0
    message.points = [_point(point) for point in marker.points]
    message.text = marker.text
    return message


def _point(point: tuple[float, float, float]) -> Point:
    x, y, z = point
    return Point(x=x, y=y, z=z)


def status_message(name: str, level: bytes, text: str, values: dict[str, Any], stamp: Time) -> DiagnosticArray:
    """A ``diagnostic_msgs/DiagnosticArray`` with one status."""
    pairs = [KeyValue(key=key, value=str(value)) for key, value in values.items()]
    status = DiagnosticStatus(level=level, name=name, message=text, hardware_id="", values=pairs)
    message = DiagnosticArray(status=[status])
    message.header.stamp = stamp
    return message
