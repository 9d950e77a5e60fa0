"""What a frame of base asks of two wheels."""

from __future__ import annotations

from typing import Final, NamedTuple, Self

from giraff_base.drives.wheels.config import WheelsConfig
from giraff_core.robot import RobotConfig
from giraff_schemas.wire import DriveFrame, SpeedFrame

_SPEED_OFF: Final = 2e-6  # m/s: a frame has whole micrometres a second


class WheelRequest(NamedTuple):
    """What base asks of the wheels, m/s."""

    left: float
    right: float
    off: float
    """By rounding."""

    @classmethod
    def by(cls, frame: DriveFrame | SpeedFrame, robot: RobotConfig, drive: WheelsConfig) -> Self:
        """What a frame stands for."""
        if isinstance(frame, SpeedFrame):
            return cls(frame.left_um_s * 1e-6, frame.right_um_s * 1e-6, _SPEED_OFF)
        speed_per_level = robot.max_wheel_speed / drive.max_level
        return cls(frame.left_level * speed_per_level, frame.right_level * speed_per_level, speed_per_level)

    def __str__(self) -> str:
        return f"{self.left:+.3f}, {self.right:+.3f} m/s"
