"""Fixed rates without bursts, and turns that need not wait for them."""

import math
from typing import Final

LEAST_GAP: Final = 0.005
"""s between two early turns for one cause: a flood makes no more of them."""
_PATIENCE: Final = 1.25
"""Periods from an early turn to the next regular one."""


class Timer:
    """Tells when the next turn of a fixed rate is due. Turns that were missed are skipped, never made up for."""

    def __init__(self, rate_hz: float) -> None:
        self.period = 1.0 / rate_hz
        self._next: float | None = None

    def due(self, now: float, early: float = 0.0) -> bool:
        """Return whether a turn is due at `now` (s, any monotonic clock); the schedule then moves on past `now`.

        `early`: s. A turn for another cause takes this one along where it would come so soon. The schedule goes on from
        there, so that it keeps step with what comes at a multiple of its rate.
        """
        if self._next is None:
            self._next = now
        if now < self._next - early:
            return False
        self._next = min(self._next, now)
        self._next += self.period
        if self._next <= now:
            self._next = now + self.period
        return True

    def wait(self, now: float) -> float:
        """Seconds until the next turn; 0 when it is due."""
        return 0.0 if self._next is None else max(0.0, self._next - now)


class EarlyTimer(Timer):
    """A fixed rate, and at once what cannot wait for it.

    An early turn puts off the next regular one, by a little more than a period: what comes at this very rate makes all
    the turns by itself then, although it comes now and then a bit late.
    """

    def __init__(self, rate_hz: float) -> None:
        super().__init__(rate_hz)
        self._early_at: dict[str, float] = {}  # by cause, when the turn that it asks for is due
        self._last: dict[str, float] = {}  # and when it had its last one

    def fire_now(self, cause: str, now: float) -> None:
        """Have a turn come now, or `LEAST_GAP` after the last one for this cause."""
        self._early_at.setdefault(cause, max(now, self._last.get(cause, -math.inf) + LEAST_GAP))

    def due(self, now: float, early: float = 0.0) -> bool:
        causes = [cause for cause, at in self._early_at.items() if at <= now]
        if not (causes or super().due(now, early)):
            return False
        if causes:
            self._last.update(dict.fromkeys(causes, now))
            self._next = now + _PATIENCE * self.period
        self._early_at.clear()  # a turn takes all that has come, whoever asked for it
        return True

    def wait(self, now: float) -> float:
        early = min(self._early_at.values(), default=math.inf)
        return min(super().wait(now), max(0.0, early - now))
