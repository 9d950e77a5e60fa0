"""Text and truth as ROS messages."""

from __future__ import annotations

from rosbags.typesys.stores.ros2_kilted import std_msgs__msg__Bool as Bool
from rosbags.typesys.stores.ros2_kilted import std_msgs__msg__String as String


def text(data: str) -> String:
    """Return a text."""
    return String(data)


def truth(data: bool) -> Bool:
    """Return a truth value."""
    return Bool(data)
