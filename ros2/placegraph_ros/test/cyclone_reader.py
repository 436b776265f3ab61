"""Reads one nav_msgs/OccupancyGrid by Cyclone DDS, with types declared by hand: prints its size and the SHA-256 of its cells.

Run: cyclone_reader.py TOPIC SECONDS
"""

import hashlib
import sys
import time
from dataclasses import dataclass

import cyclonedds.idl.annotations as ann
from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import float32, float64, int8, int32, sequence, uint32
from cyclonedds.sub import DataReader, Subscriber
from cyclonedds.topic import Topic
from cyclonedds.util import duration


def dds(name: str) -> str:
    """The name that DDS has for a message of ROS."""
    package, message = name.split("/")
    return f"{package}::msg::dds_::{message}_"


@dataclass
@ann.final
class Time(IdlStruct, typename=dds("builtin_interfaces/Time")):
    sec: int32
    nanosec: uint32


@dataclass
@ann.final
class Header(IdlStruct, typename=dds("std_msgs/Header")):
    stamp: Time
    frame_id: str


@dataclass
@ann.final
class Point(IdlStruct, typename=dds("geometry_msgs/Point")):
    x: float64
    y: float64
    z: float64


@dataclass
@ann.final
class Quaternion(IdlStruct, typename=dds("geometry_msgs/Quaternion")):
    x: float64
    y: float64
    z: float64
    w: float64


@dataclass
@ann.final
class Pose(IdlStruct, typename=dds("geometry_msgs/Pose")):
    position: Point
    orientation: Quaternion


@dataclass
@ann.final
class MapMetaData(IdlStruct, typename=dds("nav_msgs/MapMetaData")):
    map_load_time: Time
    resolution: float32
    width: uint32
    height: uint32
    origin: Pose


@dataclass
@ann.final
class OccupancyGrid(IdlStruct, typename=dds("nav_msgs/OccupancyGrid")):
    header: Header
    info: MapMetaData
    data: sequence[int8]


def main() -> int:
    topic, seconds = sys.argv[1], float(sys.argv[2])
    participant = DomainParticipant(0)
    qos = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.Durability.TransientLocal, Policy.History.KeepLast(1))
    reader = DataReader(Subscriber(participant), Topic(participant, f"rt{topic}", OccupancyGrid), qos=qos)
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        for grid in reader.take(1):
            cells = bytes(value & 0xFF for value in grid.data)
            print(grid.info.width, grid.info.height, grid.header.frame_id, hashlib.sha256(cells).hexdigest())
            return 0
        time.sleep(0.05)
    print("nothing arrived", file=sys.stderr)
    return 1


if __name__ == "__main__":
    sys.exit(main())
