"""Hears everything of a robot, at the least cost: most of it is waking up for each sample, and Zenoh's reading of it.

One subscriber for all keys, and in its callback nothing but a clock and a queue; what a sample says is looked at later,
many at once. Nothing is asked of the publishers, and nothing of them waits: what does not come through is dropped.
"""

import ctypes
import itertools
import os
import threading
import time
from collections import deque
from collections.abc import Iterable
from contextlib import suppress
from typing import Any, Final

import zenoh

from giraff_mcap.raw_sample import RawSample, row_of

_MOST_WAITING: Final = 40_000
"""Samples, a minute and a half of a whole robot: the queue while a disk hangs."""
_NICE: Final = 5
"""Behind all that the robot does, and before nothing: a single thread far behind (10, 19) has less of a busy machine
than it takes to listen, and its links end because it does not say in time that it is there."""
_ONE_THREAD: Final = "(net: (worker_threads: 1), {})".format(
    ", ".join(f"{runtime}: (handover: net)" for runtime in ("rx", "acc", "tx", "app"))
)
"""Zenoh's ZENOH_RUNTIME. With threads for each kind of work a sample wakes one that sees it come, one that reads it and
one that looks whether there is more to do. A service needs them, because what ends one link must not hold up the
others; here `giraff_node.network.tcp_options` alone has to do."""
_MOST_ATTACHED: Final = 32  # threads; there is one but for moments, when a link comes or goes
_MOST_DECLARED: Final = 200  # keys; a robot has some twenty


def lower_priority() -> None:
    """Let everything else of this machine go first, and wake up but once a sample.

    Before the session is opened, whose threads are then such ones.
    """
    os.environ["ZENOH_RUNTIME"] = _ONE_THREAD
    with suppress(OSError):  # where that is not permitted it is not a reason not to record
        os.nice(_NICE)


class RawSubscriber:
    """Listens from the beginning of its life; `pop_all` from one thread only."""

    def __init__(self, session: zenoh.Session, keys: Iterable[str]) -> None:
        """`session`: of the recorder alone."""
        self._session = session
        self._waiting: deque[tuple[int, zenoh.KeyExpr, bytes, str]] = deque(maxlen=_MOST_WAITING)
        self._encodings: dict[zenoh.KeyExpr, str] = {}
        """By key of the topics table, whose encoding never changes. To read it costs as much as the payload."""
        self._numbers = itertools.count(1)
        self._came = self._taken = 0
        self._declared: list[Any] = []
        self._attached: set[int] = set()
        # Not in a thread of Python's own, which would have to be woken, too.
        callback = zenoh.handlers.Callback(self._on_sample, indirect=False)
        self._subscribers: list[Any] = [session.declare_subscriber(key, callback) for key in keys]

    @property
    def overrun(self) -> int:
        """Samples that came and could not wait any longer."""
        return max(0, self._came - self._taken - len(self._waiting))

    def pop_all(self) -> list[RawSample]:
        """What has come since the last call."""
        came = [self._waiting.popleft() for _ in range(len(self._waiting))]
        self._taken += len(came)
        samples = [RawSample(at_ns, str(key), payload, encoding) for at_ns, key, payload, encoding in came]
        for (_, key, _, encoding), sample in zip(came, samples, strict=True):
            if key not in self._encodings and len(self._declared) < _MOST_DECLARED and row_of(sample.key):
                self._encodings[key] = encoding
                # Of a key that it knows Zenoh keeps to whom it goes, and looks for that no more with each sample.
                self._declared.append(self._session.declare_keyexpr(key))
        return samples

    def close(self) -> None:
        """Listen no longer."""
        for subscriber in self._subscribers:
            subscriber.undeclare()

    def _on_sample(self, sample: zenoh.Sample) -> None:
        # As little as can be: what is looked at here is looked at with the processor's caches full of other things. Of
        # the payload the bytes, because the sample would keep Zenoh's buffer of 64 kB from being used again.
        at_ns, key, payload = time.monotonic_ns(), sample.key_expr, sample.payload.to_bytes()
        if not payload and sample.kind == zenoh.SampleKind.DELETE:
            return  # no message, which may be empty as well
        self._waiting.append((at_ns, key, payload, self._encodings.get(key) or str(sample.encoding)))
        self._came = next(self._numbers)
        if (thread := threading.get_ident()) not in self._attached and len(self._attached) < _MOST_ATTACHED:
            # Python makes what it keeps of a foreign thread anew for each callback, and throws it away, at as much as
            # the callback costs; not of one that has not let go of Python since.
            self._attached.add(thread)
            ctypes.pythonapi.PyGILState_Ensure()
