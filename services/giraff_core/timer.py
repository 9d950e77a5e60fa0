"""Fixed rates without bursts."""


class Timer:
    """Tells when the next turn of a fixed rate is due. Turns that were missed are skipped, never made up for."""

    def __init__(self, rate_hz: float) -> None:
        self.period = 1.0 / rate_hz
        self._next: float | None = None

    def due(self, now: float) -> bool:
        """Whether a turn is due at `now` (s, any monotonic clock); the schedule then moves on past `now`."""
        if self._next is None:
            self._next = now
        if now < self._next:
            return False
        self._next += self.period
        if self._next <= now:
            self._next = now + self.period
        return True

    def wait(self, now: float) -> float:
        """Seconds until the next turn; 0 when it is due."""
        return 0.0 if self._next is None else max(0.0, self._next - now)
