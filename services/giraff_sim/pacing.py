"""Simulated time at the pace of the wall's, without bursts."""

from __future__ import annotations


class WallPacer:
    """Says how long to wait before the next slice. Clocks are the caller's: seconds and simulated us.

    A simulation that is a little late runs on without waiting. One that is very late would rush through its
    backlog and outrun whoever commands the boards; it lets the time slip instead and counts it as skew.
    """

    def __init__(self, slip_after: float = 0.05) -> None:
        """`slip_after`: s."""
        self.skew = 0.0
        """s by which simulated time has slipped behind the wall's."""
        self.slips = 0
        """How often it did."""
        self._slip_after = slip_after
        self._start: float | None = None
        self._start_us = 0

    def wait(self, wall: float, simulated_us: int) -> float:
        """Seconds to wait now that the simulation has reached `simulated_us`; 0 when it is late."""
        if self._start is None:
            self._start, self._start_us = wall, simulated_us
        due = self._start + self.skew + (simulated_us - self._start_us) * 1e-6
        late = wall - due
        if late > self._slip_after:
            self.skew += late
            self.slips += 1
            return 0.0
        return max(0.0, -late)
