"""Whether the machine itself stalled: on each processor a process that only sleeps, and tells of oversleeping."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

_SLEEPER = """
import os, sys, time
os.sched_setaffinity(0, {int(sys.argv[1])})
due = time.monotonic_ns()
while True:
    due += 2_000_000
    time.sleep(max(0, due - time.monotonic_ns()) / 1e9)
    late = time.monotonic_ns() - due
    if late > 500_000:
        print(due, due + late, flush=True)
        due += late
"""
_AROUND = 10_000_000
"""ns that one who waits for a processor may be behind the sleeper, who is never owed any time."""


class Stalls:
    """Times when a sleeper woke too late."""

    def __init__(self, files: list[Path]) -> None:
        self._files = files

    def at(self, begin_ns: int, end_ns: int) -> bool:
        """Whether any was within this time of `time.monotonic_ns`."""
        return any(begin - _AROUND <= end_ns and begin_ns <= end + _AROUND for begin, end in self._spans())

    def longest(self, since_ns: int) -> float:
        """s, of those that ended since; 0 if none did."""
        return max((end - begin for begin, end in self._spans() if end >= since_ns), default=0) * 1e-9

    def _spans(self) -> list[tuple[int, int]]:
        lines = [line.split() for file in self._files for line in file.read_text().splitlines()]
        return [(int(begin), int(end)) for begin, end in lines]


@contextmanager
def stalls_seen(directory: Path) -> Iterator[Stalls]:
    """From now until the end of the block."""
    processors = sorted(os.sched_getaffinity(0))
    files = [directory / f"stalls.{processor}" for processor in processors]
    sleepers = []
    try:
        for processor, file in zip(processors, files, strict=True):
            with file.open("w") as out:
                command = [sys.executable, "-S", "-c", _SLEEPER, str(processor)]
                sleepers.append(subprocess.Popen(command, stdout=out))
        yield Stalls(files)
    finally:
        for sleeper in sleepers:
            sleeper.kill()
            sleeper.wait()
