"""Parts that several ROS messages have: stamps, frames, rotations, numbers of 32 bits."""

import math
from typing import Final

from rosbags.typesys.stores.ros2_kilted import builtin_interfaces__msg__Time as Time
from rosbags.typesys.stores.ros2_kilted import geometry_msgs__msg__Quaternion as Quaternion
from rosbags.typesys.stores.ros2_kilted import std_msgs__msg__Header as Header

_SECOND: Final = 1_000_000_000
_LATEST: Final = 2**31 * _SECOND - 1
_LARGEST_SINGLE: Final = 3.4e38


def stamp(stamp_ns: int) -> Time:
    """Return a moment. `stamp_ns`: ns since 1970; ROS counts its seconds with 31 bits, so it is limited to them."""
    return Time(*divmod(min(max(stamp_ns, 0), _LATEST), _SECOND))


def header(stamp_ns: int, frame: str) -> Header:
    """Return the header of a message of this moment, in this frame."""
    return Header(stamp(stamp_ns), frame)


def quaternion(roll: float, pitch: float, yaw: float) -> Quaternion:
    """Return the rotation Rz(yaw) Ry(pitch) Rx(roll); all in rad."""
    sin_r, cos_r = math.sin(roll / 2), math.cos(roll / 2)
    sin_p, cos_p = math.sin(pitch / 2), math.cos(pitch / 2)
    sin_y, cos_y = math.sin(yaw / 2), math.cos(yaw / 2)
    return Quaternion(
        x=sin_r * cos_p * cos_y - cos_r * sin_p * sin_y,
        y=cos_r * sin_p * cos_y + sin_r * cos_p * sin_y,
        z=cos_r * cos_p * sin_y - sin_r * sin_p * cos_y,
        w=cos_r * cos_p * cos_y + sin_r * sin_p * sin_y,
    )


def single(value: float) -> float:
    """Return a number that fits 32 bits: one that is too large for them becomes infinite, and is not refused."""
    return math.copysign(math.inf, value) if abs(value) > _LARGEST_SINGLE else value
