"""The ramp of starts: a stop is immediate."""

from __future__ import annotations

import math

from giraff_base.config import BaseConfig
from giraff_core.live import Live

_LONGEST_STEP = 0.02  # s, two reports of the board: a ramp does not jump after a pause


def ramped(now_at: float, target: float, largest_step: float) -> float:
    """The next value from `now_at` to `target`: away from zero by at most `largest_step`, towards it at once.

    A reversal passes through zero: what is asked in the old direction ends now, the new one starts from rest.
    """
    if math.copysign(1.0, now_at) != math.copysign(1.0, target):
        now_at = 0.0
    return math.copysign(min(abs(target), abs(now_at) + largest_step), target)


class Ramp:
    """The twist that is asked of the motors now, on its way to the one that may be driven."""

    def __init__(self, live: Live[BaseConfig]) -> None:
        self._live = live
        self.linear = self.angular = 0.0
        self._at_ns = 0

    def stop(self) -> None:
        self.linear = self.angular = 0.0

    def follow(self, linear: float, angular: float, robot_ns: int) -> None:
        """Go on to what may be driven at `robot_ns`."""
        config = self._live.config
        seconds = min(_LONGEST_STEP, max(0.0, (robot_ns - self._at_ns) * 1e-9))
        self._at_ns = robot_ns
        self.linear = ramped(self.linear, linear, config.linear_acceleration * seconds)
        self.angular = ramped(self.angular, angular, config.angular_acceleration * seconds)
