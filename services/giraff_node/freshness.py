"""Freshness without synchronized clocks: how old a sample is, told by the robot's own ticks."""

from __future__ import annotations

import math

from giraff_schemas.messages import RobotTime


def age(tick: RobotTime | None, now: RobotTime) -> float:
    """Upper bound (s) of the true age of what carries `tick`.

    Infinite when nothing is proven: no tick, a tick of another epoch or of nobody's, or one ahead of `now`.
    """
    if tick is None or tick.epoch == 0 or tick.epoch != now.epoch or tick.robot_ns > now.robot_ns:
        return math.inf
    return (now.robot_ns - tick.robot_ns) * 1e-9


def fade(age_s: float, budget: float) -> float:
    """Share of the speed that a sample of this age still earns: 1 up to half its budget, then falling to 0 at it."""
    return min(1.0, max(0.0, 2.0 - 2.0 * age_s / budget))
