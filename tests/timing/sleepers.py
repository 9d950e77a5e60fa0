"""Whether the machine itself stalled: on each processor a process that only sleeps, and tells of oversleeping."""

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
    if late > int(sys.argv[2]):
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

    def longest(self, begin_ns: int, end_ns: int) -> float:
        """s, of those that were at least in part within this time; 0 if none was."""
        within = [end - begin for begin, end in self._spans() if begin <= end_ns and begin_ns <= end]
        return max(within, default=0) * 1e-9

    def _spans(self) -> list[tuple[int, int]]:
        # What has no line's end yet is still being written.
        whole = [file.read_text().rpartition("\n")[0] for file in self._files]
        lines = [line.split() for text in whole for line in text.splitlines()]
        return [(int(begin), int(end)) for begin, end in lines]


@contextmanager
def stalls_seen(directory: Path, least: float = 0.0005) -> Iterator[Stalls]:
    """Those of `least` s and more, from now until the end of the block."""
    processors = sorted(os.sched_getaffinity(0))
    files = [directory / f"stalls.{processor}" for processor in processors]
    sleepers = []
    try:
        for processor, file in zip(processors, files, strict=True):
            with file.open("w") as out:
                command = [sys.executable, "-S", "-c", _SLEEPER, str(processor), str(round(least * 1e9))]
                sleepers.append(subprocess.Popen(command, stdout=out))
        yield Stalls(files)
    finally:
        for sleeper in sleepers:
            sleeper.kill()
            sleeper.wait()
