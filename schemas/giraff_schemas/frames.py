"""The robot's frames (REP-105), and where one is in another."""

from __future__ import annotations

from typing import Final

import msgspec

from giraff_schemas.checks import require_finite

ODOM_FRAME: Final = "odom"
"""Where the robot was when odometry began."""
BASE_FRAME: Final = "base_link"
"""The middle between the wheels, on the floor."""


def range_frame(sensor: str) -> str:
    """The frame of an ultrasonic sensor."""
    return f"range_{sensor}_link"


class Transform(msgspec.Struct, frozen=True, kw_only=True):
    """Answer to who asks where a frame is: its pose in its parent."""

    parent: str
    child: str
    x: float
    """m."""
    y: float
    yaw: float
    """rad, counter-clockwise positive."""
    fixed: bool
    """It is a part's place on the robot, and stays; else it is where the robot is now."""

    def __post_init__(self) -> None:
        require_finite(self, self.x, self.y, self.yaw)
