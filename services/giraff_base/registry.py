"""The drive of each kind that a robot file can name."""

from typing import assert_never

from giraff_base.config import BaseConfig
from giraff_base.drive import Drive
from giraff_base.drives.balancer.config import BalancerConfig
from giraff_base.drives.wheels.config import WheelsConfig
from giraff_base.drives.wheels.drive import WheelsDrive
from giraff_core.robot import RobotConfig


def drive_of(robot: RobotConfig, config: BaseConfig) -> Drive:
    """Return the drive that `[base.drive]` names."""
    # The faster wheel's, where driving and turning start at once. The ramp of base may be made gentler live.
    _, acceleration = robot.kinematics.wheel_speeds(config.linear_acceleration, config.angular_acceleration)
    match config.drive:
        case WheelsConfig() as wheels:
            return WheelsDrive(robot, wheels, acceleration)
        case BalancerConfig() as balancer:
            from giraff_base.drives.balancer.drive import BalancerDrive  # noqa: PLC0415  few robots balance

            return BalancerDrive(robot, balancer)
        case _ as never:
            assert_never(never)
