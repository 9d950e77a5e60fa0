"""Waiting for whichever of several descriptors is readable first, while they come and go."""

import contextlib
import errno
import select
import socket
from collections.abc import Iterable
from typing import Final

from giraff_core.io import Selectable

_SELECTABLE: Final = 1024
"""Descriptors below it are served by select."""


class Waker:
    """Ends a wait from signal handlers and other threads, by a pipe of its own.

    An Event that is set in a signal handler deadlocks while the main thread waits on it.
    """

    def __init__(self) -> None:
        self._read_end, self._write_end = socket.socketpair()
        self._read_end.setblocking(False)
        self._write_end.setblocking(False)

    @property
    def for_signals(self) -> int:
        """What `signal.set_wakeup_fd` takes."""
        return self._write_end.fileno()

    def descriptor(self) -> int | None:
        return self._read_end.fileno()

    def wake(self) -> None:
        with contextlib.suppress(BlockingIOError):  # full: the loop is about to wake anyway
            self._write_end.send(b"\0")

    def drain(self) -> None:
        """Take what has woken the loop."""
        with contextlib.suppress(BlockingIOError):
            self._read_end.recv(4096)

    def close(self) -> None:
        """Nobody wakes it any more."""
        self._read_end.close()
        self._write_end.close()


def wait_for(watched: Iterable[Selectable], seconds: float) -> set[Selectable]:
    """Wait at most `seconds` until one of these is readable; return which are."""
    there = {descriptor: each for each in watched if (descriptor := each.descriptor()) is not None}
    # Not poll, which wakes up to a millisecond late: only where there are more descriptors than select serves.
    if max(there, default=0) < _SELECTABLE:
        try:
            readable, _, _ = select.select(there, (), (), seconds)
        except OSError as error:
            if error.errno != errno.EBADF:
                raise
            return set()  # a turn in another thread has closed it just now
        return {there[descriptor] for descriptor in readable}
    poll = select.poll()
    for descriptor in there:
        poll.register(descriptor, select.POLLIN)
    return {there[descriptor] for descriptor, _ in poll.poll(seconds * 1000.0)}
