"""Whether the machine itself stood still: a probe beside a test that depends on the wall clock."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Self, TypeVar

_PERIOD = 0.005  # s
_STALL = 0.05  # s
_REPEATS = 3

ResultT = TypeVar("ResultT")


class StallProbe:
    """Sleeps 5 ms at a time, and remembers the longest time by which it woke late."""

    def __init__(self) -> None:
        self.longest = 0.0
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
            self.longest = max(self.longest, now - last - _PERIOD)
            last = now


def without_stall(run: Callable[[], ResultT]) -> ResultT:
    """The result of a `run` during which the machine did not stall for over 50 ms; the others are repeated.

    The last repetition counts whatever the machine did: a test must not wait for ever for a quiet one.
    """
    repeats = 0
    while True:
        with StallProbe() as probe:
            result = run()
        print(f"longest stall of this machine: {probe.longest * 1e3:.0f} ms; runs repeated so far: {repeats}")
        if probe.longest <= _STALL or repeats == _REPEATS:
            return result
        repeats += 1
