"""Whether the machine itself stood still: a probe beside a test that depends on the wall clock."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Self, TypeVar

_PERIOD = 0.005  # s
_STALL = 0.05  # s
_REPEATS = 3
_SHARE = 0.2  # of all runs that a campaign may repeat

ResultT = TypeVar("ResultT")


class StallProbe:
    """Sleeps 5 ms at a time, and remembers the longest time by which it woke late."""

    def __init__(self) -> None:
        self.longest = 0.0
        self.stalls: list[float] = []
        """Ends of those over 50 ms, s of time.monotonic()."""
        self._ending = threading.Event()
        self._thread = threading.Thread(target=self._watch, daemon=True)

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ending.set()
        self._thread.join()

    def _watch(self) -> None:
        last = time.monotonic()
        while not self._ending.is_set():
            time.sleep(_PERIOD)
            now = time.monotonic()
            late = now - last - _PERIOD
            self.longest = max(self.longest, late)
            if late > _STALL:
                self.stalls.append(now)
            last = now


@dataclass
class Tally:
    """The runs of a campaign: how many were repeated because the machine stood still."""

    runs: int = 0
    repeated: int = 0
    longest: float = 0.0
    """s, of the stalls within runs that counted."""

    def require_quiet(self) -> None:
        """A machine that stalls all the time proves nothing."""
        assert self.repeated <= _SHARE * self.runs, (
            f"{self.repeated} of {self.runs} runs were repeated because this machine stalled; "
            "relieve it and run the campaign again"
        )


def without_stall(run: Callable[[], ResultT], tally: Tally | None = None) -> ResultT:
    """The result of a `run` during which the machine did not stall for over 50 ms; the others are repeated.

    The last repetition counts whatever the machine did: a test must not wait for ever for a quiet one.
    """
    tally = tally or Tally()
    repeats = 0
    while True:
        with StallProbe() as probe:
            result = run()
        tally.runs += 1
        print(f"longest stall of this machine: {probe.longest * 1e3:.0f} ms; runs repeated so far: {repeats}")
        if probe.longest <= _STALL or repeats == _REPEATS:
            tally.longest = max(tally.longest, probe.longest)
            return result
        tally.repeated += 1
        repeats += 1
