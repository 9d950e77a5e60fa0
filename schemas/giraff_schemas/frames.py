"""The robot's frames (REP-105), and where one is in another."""

from typing import Final

import msgspec

from giraff_schemas.checks import require_finite
from giraff_schemas.messages import RobotTime

MAP_FRAME: Final = "map"
"""The floor plan's own."""
ODOM_FRAME: Final = "odom"
"""Where the robot was when odometry began."""
BASE_FRAME: Final = "base_link"
"""The middle between the wheels, on the floor."""


def range_frame(sensor: str) -> str:
    """The frame of an ultrasonic sensor."""
    return f"range_{sensor}_link"


def camera_frame(camera: str) -> str:
    """The frame of a camera: x where it looks, y to its left (REP-103)."""
    return f"camera_{camera}_link"


class Transform(msgspec.Struct, frozen=True, kw_only=True):
    """Where a frame is: its pose in its parent. Answer to who asks for it, and what a look-up finds."""

    parent: str
    child: str
    x: float
    """m."""
    y: float
    z: float = 0.0
    """m, up."""
    roll: float = 0.0
    """rad. Roll, pitch and yaw are REP-103's, about the parent's fixed axes in this order: R = Rz(yaw) Ry(pitch)
    Rx(roll)."""
    pitch: float = 0.0
    """rad; positive: what looks ahead looks down."""
    yaw: float
    """rad, counter-clockwise positive."""
    fixed: bool
    """It is a part's place on the robot, and stays; else it is where the robot is now, or was at `tick`."""
    tick: RobotTime | None = None
    """The moment of which it is, where it is not fixed; None: of now, as far as who tells it knows."""

    def __post_init__(self) -> None:
        require_finite(self, self.x, self.y, self.z, self.roll, self.pitch, self.yaw)
