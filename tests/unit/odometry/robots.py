"""The robot and the wheels of these tests."""

import msgspec

from giraff_core.kinematics.calibration import EXACTLY, Calibration
from giraff_schemas.messages import RobotTime, Wheels
from tests.support import robots

KNOWN = Calibration(covariance=EXACTLY)
"""Nobody doubts its wheels and its track: what is left is what is random."""
ROBOT = msgspec.structs.replace(robots.ROBOT, ticks_per_metre=2000.0, calibration=KNOWN)

PERIOD_US = 10_000


def signed32(count: int) -> int:
    """A count as a 32-bit counter shows it."""
    return (count + (1 << 31)) % (1 << 32) - (1 << 31)


BOOTED_S = 3600.0
"""Base's clock when the board's is at 0."""


def wheels(
    left: int = 0,
    right: int = 0,
    board_us: int = 0,
    *,
    boot_id: int = 1,
    instance: str = "base-1",
    robot_s: float | None = None,
    speeds: tuple[float, float] = (0.0, 0.0),
) -> Wheels:
    """A report of counters that may have wrapped. `robot_s`: base's clock since BOOTED_S, the board's when left out."""
    since_s = board_us / 1e6 if robot_s is None else robot_s
    return Wheels(
        instance=instance,
        left_ticks=signed32(left),
        right_ticks=signed32(right),
        left_velocity=speeds[0],
        right_velocity=speeds[1],
        left_pwm_counts=0,
        right_pwm_counts=0,
        board_us=board_us % (1 << 32),
        boot_id=boot_id,
        tick=RobotTime(epoch=3, robot_ns=round((BOOTED_S + since_s) * 1e9)),
    )
