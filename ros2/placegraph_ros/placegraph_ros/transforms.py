"""Where the robot is, from TF."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

PERIOD_S = 0.2
"""How often the robot's place is asked for."""


def follow_frame(
    node: Any, base_frame: str, map_frame: Callable[[], str | None], move_to: Callable[[float, float], None]
) -> bool:
    """Calls ``move_to`` with the position of ``base_frame`` in the frame of the map; returns whether there is tf2."""
    try:
        from tf2_ros import Buffer, TransformException, TransformListener
    except ImportError:
        return False
    from rclpy.time import Time

    buffer = Buffer()
    listener = TransformListener(buffer, node)

    def look() -> None:
        target = map_frame()
        if target is None:
            return
        try:
            found = buffer.lookup_transform(target, base_frame, Time())
        except TransformException as error:
            node.get_logger().warning(f"there is no transform: {error}", throttle_duration_sec=10.0)
            return
        move_to(found.transform.translation.x, found.transform.translation.y)

    timer = node.create_timer(PERIOD_S, look)
    # They work as long as somebody holds them.
    node._transforms = (buffer, listener, timer)
    return True
