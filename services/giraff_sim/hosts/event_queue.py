"""What is to happen at which simulated moment, and the log of what has happened, in plain words."""

import heapq
import re
from collections import Counter
from collections.abc import Callable
from typing import Final

_VARIES: Final = re.compile(r"\b[0-9a-f]{8}\b|[0-9]+(\.[0-9]+)?")  # instances and numbers

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


class EventLog:
    """A timeline, and what it counts."""

    def __init__(self, agenda: EventQueue) -> None:
        self._agenda = agenda
        self.lines: list[str] = []
        self.counts: Counter[str] = Counter()

    def log(self, what: str) -> None:
        """Put `what` down at the present moment."""
        self.lines.append(f"{self._agenda.now_us / 1e6:7.3f} s  {what}")

    def count(self, what: str) -> None:
        self.counts[what] += 1


def kind_of(reason: str) -> str:
    """Return a reason with N for each number and instance, so that equal causes count as one."""
    return _VARIES.sub("N", reason)
