"""Hears everything of a robot, at the least cost: nearly all of it is Zenoh's own, in its receiving threads.

One subscriber for all keys, and in its callback nothing but a clock and a queue; what a sample says is looked at later,
many at once. Nothing is asked of the publishers, and nothing of them waits: what does not come through is dropped.
"""

from __future__ import annotations

import os
import time
from collections import deque
from collections.abc import Iterable
from contextlib import suppress
from typing import Any, Final

import zenoh

from giraff_mcap.heard import Heard

_MOST_WAITING: Final = 40_000
"""Samples, a minute and a half of a whole robot: the queue while a disk hangs."""
_NICE: Final = 10
"""Behind all that the robot does, and before nothing: at the very last (19) a recorder gets 1.5 % of a busy core, which
is less than it takes to listen."""


def step_back() -> None:
    """Let everything else of this machine go first. Before the session is opened, whose threads then do so, too."""
    with suppress(OSError):  # where that is not permitted it is not a reason not to record
        os.nice(_NICE)


class Ear:
    """Listens from the beginning of its life; `take` from one thread only."""

    def __init__(self, session: zenoh.Session, keys: Iterable[str]) -> None:
        """`session`: of the recorder alone."""
        self._waiting: deque[tuple[int, zenoh.Sample]] = deque(maxlen=_MOST_WAITING)
        self._encodings: dict[str, str] = {}
        """By key: it is the same for all samples of one, and costs as much as the payload."""
        self._came = self._taken = 0
        self._subscribers: list[Any] = [session.declare_subscriber(key, self._on_sample) for key in keys]

    @property
    def overrun(self) -> int:
        """Samples that came and could not wait any longer."""
        return max(0, self._came - self._taken - len(self._waiting))

    def take(self) -> list[Heard]:
        """What has come since the last call."""
        taken = []
        for _ in range(len(self._waiting)):
            at_ns, sample = self._waiting.popleft()
            self._taken += 1
            if sample.kind == zenoh.SampleKind.PUT:
                key = str(sample.key_expr)
                encoding = self._encodings.get(key) or self._encodings.setdefault(key, str(sample.encoding))
                taken.append(Heard(at_ns, key, sample.payload.to_bytes(), encoding))
        return taken

    def close(self) -> None:
        """Listen no longer."""
        for subscriber in self._subscribers:
            subscriber.undeclare()

    def _on_sample(self, sample: zenoh.Sample) -> None:
        self._waiting.append((time.monotonic_ns(), sample))
        self._came += 1
