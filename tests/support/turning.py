"""A service's process within a test: its loop and its turns, without a session."""

import contextlib
import signal
from collections.abc import Iterator

from giraff_node.process.lifecycle import Process


@contextlib.contextmanager
def turning_process() -> Iterator[Process]:
    """Yield one, and give the signals back at the end."""
    kept = {number: signal.getsignal(number) for number in (signal.SIGTERM, signal.SIGINT)}
    process = Process("under_test")
    try:
        yield process
    finally:
        signal.set_wakeup_fd(-1)
        process._waker.close()
        for number, handler in kept.items():
            signal.signal(number, handler)
