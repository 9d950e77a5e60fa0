"""The processor time of tests, in seconds of the machine on which the limits of tests/budget.toml were measured.

A short loop is timed beside the tests, in the same process: where it takes twice its time, so do they. A slow or busy
machine therefore takes as many of these seconds as a fast one.
"""

import os
import time
from collections import deque
from statistics import mean, median
from typing import Final

import msgspec

PASS_TAKES: Final = 0.00235
"""Processor seconds of one pass of the loop on that machine, while nothing else runs there."""
PASS_EVERY: Final = 0.25
"""Processor seconds between two passes, which therefore take a hundredth."""
PASSES: Final = 9
"""The last ones count: their median passes over one that was disturbed, and follows a machine that becomes busy."""
MOST_UNSTEADY: Final = 0.25
"""Share by which a limit is raised at most where the machine is unsteady."""


class _Sample(msgspec.Struct, frozen=True):
    tick: int
    speed: float
    mean: float
    name: str


_DECODER: Final = msgspec.msgpack.Decoder(_Sample)


def _one_pass() -> float:
    """Do what services do: samples are coded, decoded, kept and compared."""
    kept: dict[int, _Sample] = {}
    mean = 0.0
    for tick in range(4000):
        sample = _DECODER.decode(msgspec.msgpack.encode(_Sample(tick, tick * 0.5, mean, "wheel")))
        kept[sample.tick * 7919 % 1009] = sample
        mean = max(0.0, min(1e6, mean * 0.99 + sample.speed)) if sample.name == "wheel" else -1.0
    return min(kept.values(), key=lambda sample: sample.mean).speed


def taken() -> float:
    """Return the processor time (s) of this process and of those of its children that have ended."""
    return sum(os.times()[:4])


class Pace:
    """Times the loop again and again while the tests run."""

    def __init__(self) -> None:
        self.slowness = 1.0
        """The time that the last passes took, over what one takes on the table's machine."""
        self._next = 0.0
        self._passes: deque[float] = deque(maxlen=PASSES)
        self._deviations: list[float] = []

    def run(self) -> None:
        """Time one pass if the last one is long ago."""
        if (now := time.process_time()) < self._next:
            return
        began = time.thread_time()
        _one_pass()
        took = time.thread_time() - began
        if self._passes:
            self._deviations.append(abs(took / median(self._passes) - 1.0))
        self._passes.append(took)
        self.slowness = median(self._passes) / PASS_TAKES
        self._next = now + PASS_EVERY

    @property
    def unsteadiness(self) -> float:
        """Mean by which a pass was off the median of those before it, as a share: 0.04 on a quiet machine.

        Where others share its cores and caches it is 0.2, and tests are off their own time by as much.
        """
        return min(MOST_UNSTEADY, mean(self._deviations)) if self._deviations else 0.0
