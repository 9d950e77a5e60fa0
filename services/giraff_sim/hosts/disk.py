"""A machine's disk: what is on it outlives processes. Writing takes time, and can fail or hang."""

from collections import deque
from collections.abc import Callable
from functools import partial
from typing import Final

from giraff_core.estop.latch import LATCH_FILE, RELEASED, latch_bytes
from giraff_sim.hosts.event_queue import Action, EventQueue

_WRITE_US: Final = 8_000  # file, folder and their fsync, on a flash card
_FOLDER: Final = "/var/lib/giraff"


class Disk:
    """Holds the state folder of one robot, whose emergency stop is released in the beginning."""

    def __init__(self, agenda: EventQueue) -> None:
        self.files: dict[str, bytes] = {LATCH_FILE: latch_bytes(RELEASED)}
        self.trouble = ""
        """Why nothing can be written; empty: it can."""
        self.write_us = _WRITE_US
        self._hangs = False
        self._agenda = agenda
        self._held: list[Action] = []

    @property
    def works(self) -> bool:
        return not (self.trouble or self._hangs or self._held)

    def write(self, name: str, data: bytes, done: Callable[[str], None], is_wanted: Callable[[], bool]) -> None:
        """Replace a file; `done` is told why that failed. Nothing happens once it `is_wanted` no more."""
        self._agenda.at(self._agenda.now_us + self.write_us, partial(self._finish, name, data, done, is_wanted))

    def hang(self) -> None:
        """What is written from now on is not, until `go_on`."""
        self._hangs = True

    def go_on(self) -> None:
        self._hangs = False
        held, self._held = self._held, []
        for action in held:
            action()

    def _finish(self, name: str, data: bytes, done: Callable[[str], None], is_wanted: Callable[[], bool]) -> None:
        if self._hangs:
            self._held.append(partial(self._finish, name, data, done, is_wanted))
            return
        if not is_wanted():
            return
        if not self.trouble:
            self.files[name] = data
        done(f"{_FOLDER}/{name}: {self.trouble}" if self.trouble else "")


class ProcessStore:
    """The disk as one process has it, a `Store`."""

    def __init__(self, disk: Disk, is_wanted: Callable[[], bool], wake: Action) -> None:
        """`is_wanted`: whether the process still runs; `wake`: has it look for the outcome of a write."""
        self._disk = disk
        self._is_wanted = is_wanted
        self._wake = wake

    def path(self, name: str) -> str:
        return f"{_FOLDER}/{name}"

    def read(self, name: str) -> bytes:
        try:
            return self._disk.files[name]
        except KeyError:
            raise FileNotFoundError(2, "No such file or directory", self.path(name)) from None

    def writer(self, name: str) -> "ProcessWriter":
        return ProcessWriter(self._disk, name, self._is_wanted, self._wake)


class ProcessWriter:
    """Writes one file; what a process that ends meanwhile was about to write is lost."""

    def __init__(self, disk: Disk, name: str, is_wanted: Callable[[], bool], wake: Action) -> None:
        self._disk = disk
        self._name = name
        self._is_wanted = is_wanted
        self._wake = wake
        self._outcomes: deque[str] = deque()

    def save(self, data: bytes) -> None:
        self._disk.write(self._name, data, self._done, self._is_wanted)

    def outcome(self) -> str | None:
        return self._outcomes.popleft() if self._outcomes else None

    def _done(self, why_not: str) -> None:
        self._outcomes.append(why_not)
        self._wake()
