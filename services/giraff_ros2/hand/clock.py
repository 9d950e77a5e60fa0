"""Tells old messages of a publisher from new ones, though nobody knows how its clock and this host's differ."""

from __future__ import annotations

from typing import Final

OLD: Final = 0.2
"""s. A message that comes later than the quickest of the last minute by more than this is old."""
_BUCKET: Final = 10.0  # s
_BUCKETS: Final = 6


class PublisherClock:
    """The way of one publisher's messages to this host: the offset between both clocks, and the delay.

    A process that wakes pours out what it has held. The offset of such a message is worse than those before it. Nobody
    knows how old the first message is; the first quick one shows it.
    """

    def __init__(self) -> None:
        self._best: dict[int, float] = {}  # s, the smallest offset by number of the bucket

    def lateness(self, sent_ns: int, at: float) -> float:
        """Take a message, and return how much later it is than the quickest one lately, s.

        `sent_ns`: ns of any clock of the sender. `at`: s, monotonic, when it came.
        """
        offset, bucket = at - sent_ns * 1e-9, int(at // _BUCKET)
        self._best[bucket] = min(offset, self._best.get(bucket, offset))
        quickest = min(self._best.values())
        # Looked at before what is too long ago goes: after a long silence the first message still has one to compare.
        self._best = {number: best for number, best in self._best.items() if number > bucket - _BUCKETS}
        return offset - quickest
