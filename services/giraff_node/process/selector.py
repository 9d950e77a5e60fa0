"""Waiting for whichever of several descriptors is readable first, while they come and go."""

from __future__ import annotations

import contextlib
import select
import socket
from collections.abc import Iterable

from giraff_core.io import Selectable


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


def wait_for(watched: Iterable[Selectable], seconds: float) -> set[Selectable]:
    """Wait at most `seconds` until one of these is readable; which are."""
    there = {descriptor: each for each in watched if (descriptor := each.descriptor()) is not None}
    # Not epoll, which wakes up to a millisecond late. It serves descriptors below 1024 only: what is watched here is a
    # handful that a process opens as it starts, and ports.
    readable, _, _ = select.select(there, (), (), seconds)
    return {there[descriptor] for descriptor in readable}
