"""The person in front of a terminal, to whom something can be shown while they have not answered yet."""

import contextlib
import os
import select
import shutil
import signal
from collections.abc import Callable, Iterator
from pathlib import Path
from types import FrameType
from typing import Final, Protocol, TextIO

from giraff_tools.terminal.page import print_wrapped

_TURN: Final = 0.1  # s
_ERASE: Final = "\r\033[K"


class NobodyError(Exception):
    """Nobody is there any more."""


class Human(Protocol):
    """Who drives and measures."""

    def show(self, text: str) -> None: ...

    def ask(self, question: str, meanwhile: Callable[[], str]) -> str:
        """Return the line that is typed. Until then call `meanwhile` often, and show what it returns.

        Raises NobodyError.
        """
        ...


class Terminal:
    """A human in front of one, or a program behind a pipe."""

    def __init__(self, typed: TextIO, shown: TextIO) -> None:
        self._typing = typed.fileno()
        self._typed = b""
        self._shown = shown

    def show(self, text: str) -> None:
        print_wrapped(text, self._shown)

    def ask(self, question: str, meanwhile: Callable[[], str]) -> str:
        print_wrapped(question, self._shown, end=" ")
        told = ""
        while b"\n" not in self._typed:
            if (text := meanwhile()) != told:
                self._tell_meanwhile(text, is_first=not told)
                told = text
            if not select.select([self._typing], [], [], _TURN)[0]:
                continue
            if not (typed := _read(self._typing)):
                raise NobodyError
            self._typed += typed
        line, _, self._typed = self._typed.partition(b"\n")
        return line.decode(errors="replace").strip().lower()

    def _tell_meanwhile(self, text: str, *, is_first: bool) -> None:
        """On a line of its own, below the question, again and again; a pipe is spared it."""
        if self._shown.isatty():
            columns = shutil.get_terminal_size().columns
            print("\n" if is_first else _ERASE, text[: columns - 1], sep="", end="", file=self._shown, flush=True)


def _read(descriptor: int) -> bytes:
    """What was typed; nothing where nobody will any more."""
    try:
        return os.read(descriptor, 4096)
    except OSError:  # the other end of a terminal is gone
        return b""


def agrees(human: Human, question: str, meanwhile: Callable[[], str] = lambda: "") -> bool:
    while True:
        answer = human.ask(question, meanwhile)
        if answer in {"yes", "y"}:
            return True
        if answer in {"no", "n"}:
            return False
        human.show("Type yes or no.")


@contextlib.contextmanager
def signals_interrupt() -> Iterator[None]:
    """SIGTERM and a closed terminal end it as Ctrl-C does."""
    before = {number: signal.signal(number, _interrupt) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _interrupt(number: int, frame: FrameType | None) -> None:
    del number, frame
    raise KeyboardInterrupt


def introduce(human: Human, robot: str, path: Path) -> None:
    """Tell which robot it is, and where the outcome goes."""
    human.show(f"Robot {robot}; what is found goes into {path}.")
