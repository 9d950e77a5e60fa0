"""Whether a process's memory stays flat."""

import gc
from typing import Final

import psutil

LIMIT: Final = 1 << 20  # bytes that a process may grow by after its warm-up
_LOOKS: Final = 50


class Growth:
    """Of this process, or another: the resident bytes at the end, less those after the warm-up, a share of the work."""

    def __init__(self, pid: int | None = None, warm: float = 0.2) -> None:
        self._process = psutil.Process(pid)
        self._own = pid is None
        self._step = (1.0 - warm) / _LOOKS
        self._next = warm
        self._first = 0
        self.bytes = 0

    def look(self, done: float) -> None:
        """`done`: share of the work, 0..1; looks now and then."""
        if done < self._next:
            return
        self._next += self._step
        if self._own:
            gc.collect()
        size = self._process.memory_info().rss
        self._first = self._first or size
        self.bytes = size - self._first
