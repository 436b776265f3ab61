"""Starts the node: ros2 launch placegraph_ros placegraph.launch.py [rviz:=true] [map_file:=MAP.yaml]."""

from pathlib import Path

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration, PythonExpression
from launch_ros.actions import Node


def generate_launch_description() -> LaunchDescription:
    config = Path(get_package_share_directory("placegraph_ros"), "config")
    arguments = {
        "params_file": (str(config / "placegraph.yaml"), "parameters of the node"),
        "namespace": ("", "namespace of the node"),
        "map": ("map", "topic of the map"),
        "map_file": ("", "map that Nav2's map_server publishes; none where something else publishes the map"),
        "pose": ("pose", "topic of the robot's pose, such as amcl_pose"),
        "use_sim_time": ("false", "whether time is that of a simulation"),
        "rviz": ("false", "whether RViz is started as well"),
    }
    node = Node(
        package="placegraph_ros",
        executable="placegraph",
        name="placegraph",
        namespace=LaunchConfiguration("namespace"),
        parameters=[LaunchConfiguration("params_file"), {"use_sim_time": LaunchConfiguration("use_sim_time")}],
        remappings=[("map", LaunchConfiguration("map")), ("pose", LaunchConfiguration("pose"))],
        output="screen",
    )
    rviz = Node(
        package="rviz2",
        executable="rviz2",
        arguments=["-d", str(config / "placegraph.rviz")],
        condition=IfCondition(LaunchConfiguration("rviz")),
    )
    is_served = IfCondition(PythonExpression(["'", LaunchConfiguration("map_file"), "' != ''"]))
    map_server = Node(
        package="nav2_map_server",
        executable="map_server",
        name="map_server",
        namespace=LaunchConfiguration("namespace"),
        parameters=[{"yaml_filename": LaunchConfiguration("map_file"), "topic_name": LaunchConfiguration("map")}],
        condition=is_served,
    )
    manager = Node(
        package="nav2_lifecycle_manager",
        executable="lifecycle_manager",
        name="lifecycle_manager_map",
        namespace=LaunchConfiguration("namespace"),
        parameters=[{"autostart": True, "node_names": ["map_server"]}],
        condition=is_served,
    )
    declared = [
        DeclareLaunchArgument(name, default_value=default, description=text)
        for name, (default, text) in arguments.items()
    ]
    return LaunchDescription([*declared, map_server, manager, node, rviz])
