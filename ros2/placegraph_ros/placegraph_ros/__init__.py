"""A ROS 2 node that labels the occupancy grid on ``/map``. docs/ros2.md is the manual.

Only :mod:`placegraph_ros.node` and :mod:`placegraph_ros.convert` need ROS; the rest works on plain data.
"""
