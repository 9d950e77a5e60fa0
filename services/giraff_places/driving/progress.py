"""Tells when a motion brings the robot on no more. No I/O and no clock."""

import math
from typing import Final

from giraff_schemas.motion import NOWHERE, Displacement

STUCK: Final = 8.0
"""s in which the robot must come on."""
_COMES: Final = 0.1
"""m"""
_TURNS: Final = math.radians(10.0)


class Progress:
    """Watch one motion. Times are s of any one monotonic clock."""

    def __init__(self, now: float) -> None:
        self._last, self._at = NOWHERE, now

    def is_over(self, achieved: Displacement, now: float) -> bool:
        """Tell whether the robot has come nowhere for too long."""
        if abs(achieved.path - self._last.path) > _COMES or abs(achieved.yaw - self._last.yaw) > _TURNS:
            self._last, self._at = achieved, now
        return now - self._at > STUCK
