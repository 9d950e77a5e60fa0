"""Reports of the balancing board as samples."""

from __future__ import annotations

from typing import Final

from giraff_base.drives.balancer.words import cause, posture
from giraff_core.kinematics.differential_drive import DifferentialDrive
from giraff_schemas.messages import Attitude, RobotTime, Wheels
from giraff_schemas.wires.balancer import DRIVER_FULL, BalanceFrame

_FULL_PWM: Final = 255


def wheels(report: BalanceFrame, kinematics: DifferentialDrive, tick: RobotTime) -> Wheels:
    """Return what the wheels do on the floor, without what they turn as the body leans."""
    left, right = kinematics.wheel_speeds(report.speed_um_s * 1e-6, report.turn_urad_s * 1e-6)
    return Wheels(
        left_ticks=report.left_counts,
        right_ticks=report.right_counts,
        left_velocity=left,
        right_velocity=right,
        left_pwm_counts=round(report.left_command * _FULL_PWM / DRIVER_FULL),
        right_pwm_counts=round(report.right_command * _FULL_PWM / DRIVER_FULL),
        board_us=report.board_us,
        boot_id=report.boot_id,
        tick=tick,
    )


def attitude(report: BalanceFrame, pivot: float, tick: RobotTime) -> Attitude:
    """Return how the robot holds itself. `pivot`: m of its axle above the floor."""
    return Attitude(
        lean=report.lean_urad * 1e-6,
        rate=report.rate_urad_s * 1e-6,
        accelerometer_lean=report.accelerometer_urad * 1e-6,
        trim=report.trim_urad * 1e-6,
        torque=report.torque_mnm * 1e-3,
        posture=posture(report),
        cause=cause(report).what,
        tick=tick,
        pivot=pivot,
    )
