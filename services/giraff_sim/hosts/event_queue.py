"""What is to happen at which simulated moment."""

from __future__ import annotations

import heapq
from collections.abc import Callable

Action = Callable[[], None]


class EventQueue:
    """Does things in the order of their times; those of one moment in the order in which they were put down."""

    def __init__(self) -> None:
        self.now_us = 0
        self._entries: list[tuple[int, int, Action]] = []
        self._count = 0

    def at(self, us: int, action: Action) -> None:
        """Do `action` once the simulated time is `us`; a past one means now."""
        self._count += 1
        heapq.heappush(self._entries, (us, self._count, action))

    def run_until(self, now_us: int) -> None:
        """Do all that is due at `now_us`, and what that brings about at once."""
        self.now_us = now_us
        entries = self._entries
        while entries and entries[0][0] <= now_us:
            heapq.heappop(entries)[2]()
