"""Waiting for whichever of several descriptors is readable first, while they come and go."""

from __future__ import annotations

import contextlib
import selectors
import socket
from typing import Self

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


class Selector:
    """Of these things; ended by `with`."""

    def __init__(self, *watched: Selectable) -> None:
        # Not epoll, which wakes up to a millisecond late. It serves descriptors below 1024 only: what is watched here
        # is a handful that a process opens as it starts, and ports.
        self._selector = selectors.SelectSelector()
        self._descriptors: dict[Selectable, int | None] = dict.fromkeys(watched)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._selector.close()

    def wait(self, seconds: float) -> set[Selectable]:
        """Wait at most `seconds`; which of them are readable."""
        for watched, before in self._descriptors.items():
            now = watched.descriptor()
            if now == before:
                continue
            if before is not None:
                with contextlib.suppress(KeyError, ValueError):
                    self._selector.unregister(before)
            if now is not None:
                self._selector.register(now, selectors.EVENT_READ, watched)
            self._descriptors[watched] = now
        return {key.data for key, _ in self._selector.select(seconds)}
