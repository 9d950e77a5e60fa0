"""For how long both wheels have stood, by their counters: one rule of rest for odometry, motion, base and calibrate.

A wheel that rests on the edge of a count goes to and fro by one, and its board reports a speed. So a speed cannot tell
rest. A wheel stands while its counter stays on two neighbouring counts. Each further count of a wheel that creeps
leaves them.
"""

from __future__ import annotations

from typing import Final

from giraff_core.counters import elapsed_us, restart, signed32
from giraff_schemas.messages import Wheels

RESTS: Final = 0.2
"""s without motion that count as rest. A wheel that creeps by a count each 0.2 s or faster never rests."""


class Standstill:
    """Hears the samples of one robot, one after another."""

    def __init__(self) -> None:
        self.seconds = 0.0
        """s by the board's clock for which neither wheel has moved."""
        self._last: Wheels | None = None
        self._above = 0, 0  # counts of each wheel above the lower of its two neighbours

    @property
    def is_rest(self) -> bool:
        """Whether the robot rests."""
        return self.seconds >= RESTS

    def on_wheels(self, wheels: Wheels) -> None:
        """Take the next sample. A new start of the board or of base begins anew."""
        last = self._last
        if last is None or restart(last, wheels):
            self._last, self.seconds, self._above = wheels, 0.0, (0, 0)
            return
        if not (elapsed := elapsed_us(last, wheels) / 1e6):
            return
        self._last = wheels
        left = self._above[0] + signed32(wheels.left_ticks - last.left_ticks)
        right = self._above[1] + signed32(wheels.right_ticks - last.right_ticks)
        self._above = min(max(left, 0), 1), min(max(right, 0), 1)
        self.seconds = self.seconds + elapsed if self._above == (left, right) else 0.0
