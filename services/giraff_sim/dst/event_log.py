"""What happened, in plain words."""

from __future__ import annotations

import re
from collections import Counter
from typing import Final

from giraff_sim.hosts.event_queue import EventQueue

_VARIES: Final = re.compile(r"\b[0-9a-f]{8}\b|[0-9]+(\.[0-9]+)?")  # instances and numbers


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
