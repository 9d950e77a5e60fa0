"""What happened, in plain words."""

from __future__ import annotations

import re
from collections import Counter
from typing import Final

from giraff_sim.hosts.event_queue import EventQueue

_NUMBERS: Final = re.compile(r"[0-9]+(\.[0-9]+)?")


class Story:
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
    """A reason without what differs from one time to the next."""
    head = re.split(r"[;:(]", reason, maxsplit=1)[0]
    return _NUMBERS.sub("N", head).strip()
