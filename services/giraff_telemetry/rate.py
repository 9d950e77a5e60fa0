"""What the samples of one key tell about its rate and its losses, and the ages of commands."""

from collections import deque
from dataclasses import dataclass
from typing import Final

_WINDOW: Final = 3.0  # s that the rate of now looks back
_MARK_EVERY: Final = 0.25  # s


@dataclass(frozen=True)
class Totals:
    """Over a whole time."""

    lost: int = 0
    made: int = 0
    """Samples after the first."""
    took: float = 0.0
    """s in which they were made."""

    def __add__(self, other: "Totals") -> "Totals":
        return Totals(self.lost + other.lost, self.made + other.made, self.took + other.took)


class RateEstimator:
    """The samples of one maker on one key. Counts by sequence number, so that a loss does not lower the rate."""

    def __init__(self, seq: int, seconds: float) -> None:
        """The first sample; `seconds`: of the clock that this key's maker runs by."""
        self.lost = 0
        self._first_seq = self._last_seq = seq
        self._first_s = self._last_s = seconds
        self._marks: deque[tuple[float, int, int]] = deque()
        """Now and then: s, the newest number, lost before it."""

    def on_sample(self, seq: int, seconds: float) -> None:
        """A sample."""
        lost_before = self.lost
        self.lost += max(0, seq - self._last_seq - 1)
        self._last_seq, self._last_s = max(seq, self._last_seq), seconds
        if not self._marks or seconds - self._marks[-1][0] >= _MARK_EVERY:
            self._marks.append((seconds, seq, lost_before))
            while self._marks[0][0] < seconds - _WINDOW:
                self._marks.popleft()

    def begin(self) -> None:
        """Count samples and time from the newest sample on."""
        self._first_seq, self._first_s = self._last_seq, self._last_s

    @property
    def totals(self) -> Totals:
        """Since the first sample, or since `begin`."""
        return Totals(self.lost, self._last_seq - self._first_seq, self._last_s - self._first_s)

    def has_ended(self, seconds: float) -> bool:
        """Whether it has told nothing of late."""
        return seconds - self._last_s > _WINDOW

    def rate_now(self, seconds: float) -> float | None:
        """Hz over the last moments; None: too few samples to tell."""
        if self.has_ended(seconds) or not self._marks:
            return None
        since, seq, _ = self._marks[0]
        return (self._last_seq - seq) / (self._last_s - since) if self._last_s - since >= _MARK_EVERY else None

    def loses_now(self, seconds: float) -> bool:
        """Whether any were lost in the last moments."""
        return not self.has_ended(seconds) and bool(self._marks) and self.lost > self._marks[0][2]
