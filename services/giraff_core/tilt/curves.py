"""How much a tilt asks for. Axes of the sensor: x grows when tilted forward, y to the left."""

import math
from typing import Final, Literal, Protocol

from giraff_core.robot import RobotConfig

Curve = Literal["angle", "source"]

# The published curve in PWM counts is 14a - 63, 0 at the first of these accelerations and 70 at the second.
SOURCE_START: Final = 4.5  # m/s²
SOURCE_FULL: Final = 9.5  # m/s²


class CurveConfig(Protocol):
    """Which curve, and where it begins and ends."""

    @property
    def curve(self) -> Curve: ...
    @property
    def dead_zone_deg(self) -> float: ...
    @property
    def full_tilt_deg(self) -> float: ...


def asked(vector: tuple[float, float, float], config: CurveConfig, robot: RobotConfig) -> tuple[float, float]:
    """Speed (m/s) and turn (rad/s) that an acceleration (m/s²) relative to the zero asks for."""
    forward, left = _deflection(vector, config)
    fastest_turn = robot.kinematics.fastest_spin
    if config.curve == "angle":
        fastest_turn = min(fastest_turn, robot.max_angular_speed)
    return robot.kinematics.within_limits(forward * robot.max_wheel_speed, left * fastest_turn)


def _deflection(vector: tuple[float, float, float], config: CurveConfig) -> tuple[float, float]:
    """Forward and left, each as a share of full speed, -1..1."""
    x, y, z = vector
    if config.curve == "source":
        return _ramp(x, SOURCE_START, SOURCE_FULL), _ramp(y, SOURCE_START, SOURCE_FULL)
    # Each axis against the horizontal: gravity's direction alone counts, not how hard the hand shakes.
    forward = math.degrees(math.atan2(x, math.hypot(y, z)))
    left = math.degrees(math.atan2(y, math.hypot(x, z)))
    start, full = config.dead_zone_deg, config.full_tilt_deg
    return _ramp(forward, start, full), _ramp(left, start, full)


def _ramp(value: float, start: float, full: float) -> float:
    """0 within ±`start`, then in proportion up to ±1 at ±`full`, and ±1 beyond."""
    share = min(1.0, max(0.0, (abs(value) - start) / (full - start)))
    return share if value >= 0.0 else 0.0 - share  # and not -share: a negative zero would show in every log
