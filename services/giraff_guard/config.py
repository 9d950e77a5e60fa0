"""Table `[guard]` of the robot file."""

from __future__ import annotations

import math

import msgspec


class GuardConfig(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    margin: float = 0.25
    """m kept between the robot's footprint and an obstacle."""
    release: float = 0.05
    """m beyond `margin` before a blocked direction is opened again."""
    reaction_time: float = 0.10
    """s from an echo at the sensor to the wheels slowing down, without the reading's age."""
    deceleration: float = 1.5
    """m/s² that the stopping distance counts on; the robot's real one must be larger."""
    range_budget: float = 0.40
    """s; an older reading does not count: its directions are blind."""
    operator_budget: float = 0.4
    """s; an older command does not count."""
    operator_release: float = 1.0
    """s of silence after which another operator may take over."""
    creep_linear: float = 0.10
    """m/s where no sensor looks."""
    creep_angular: float = 0.35
    """rad/s while the way ahead is blocked."""
    slowest: float = 0.03
    """m/s; less is a stop."""
    reach: float = 4.0
    """m; what `clear` counts for."""
    half_cone: float = math.radians(7.5)
    """rad; an echo may come from anywhere this far off the sensor's axis."""

    incidence: float = math.radians(25.0)
    """rad between a surface's normal and the sensor's axis, up to which an HC-SR04 reads reliably."""

    def __post_init__(self) -> None:
        for field in self.__struct_fields__:
            value = getattr(self, field)
            if not (math.isfinite(value) and value > 0.0):
                raise ValueError(f"{field} is {value}: it must be a positive number")
