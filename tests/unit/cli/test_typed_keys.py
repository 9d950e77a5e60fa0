"""Keys beside a live view: read at once and unechoed, and the terminal left as it was."""

import os
import pty
import sys
import termios
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from giraff_tools.terminal.keys import Keys


class Person:
    """Who types in a terminal that is this program's, until a shell takes it."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.types, self.terminal = pty.openpty()
        self.in_front = os.getpgrp()
        os.set_blocking(self.types, False)
        monkeypatch.setattr(sys, "stdin", os.fdopen(self.terminal, closefd=False))
        monkeypatch.setattr(os, "tcgetpgrp", lambda _: self.in_front)

    def type(self, text: bytes) -> None:
        os.write(self.types, text)

    def modes(self) -> list[Any]:
        return termios.tcgetattr(self.terminal)


@pytest.fixture
def person(monkeypatch: pytest.MonkeyPatch) -> Iterator[Person]:
    made = Person(monkeypatch)
    yield made
    os.close(made.types)
    os.close(made.terminal)


def test_keys_are_read_one_by_one_and_the_terminal_is_left_as_it_was(person: Person) -> None:
    before = person.modes()
    keys = Keys()
    assert keys.read() == ""
    person.type(b"c")
    assert keys.read() == "c"
    with pytest.raises(BlockingIOError):
        os.read(person.types, 1)  # no echo
    assert person.modes()[3] & termios.ISIG, "Ctrl-C ends the run"
    person.type(b"ls\n")
    keys.close()
    assert person.modes() == before
    os.set_blocking(person.terminal, False)
    with pytest.raises(BlockingIOError):
        os.read(person.terminal, 1)


def test_a_run_in_the_background_leaves_the_shell_its_terminal(person: Person) -> None:
    before, keys = person.modes(), Keys()
    person.in_front += 1
    person.type(b"c\n")
    assert keys.read() == ""
    assert person.modes() == before
    person.in_front -= 1
    assert keys.read() == "c\n"
    termios.tcsetattr(person.terminal, termios.TCSANOW, before)  # by the shell
    assert keys.read() == ""
    person.type(b"c")
    assert keys.read() == "c"
    keys.close()
    assert person.modes() == before


def test_without_a_terminal_nothing_is_typed(monkeypatch: pytest.MonkeyPatch) -> None:
    with Path(os.devnull).open(encoding="utf-8") as nothing:
        monkeypatch.setattr(sys, "stdin", nothing)
        keys = Keys()
        assert keys.read() == ""
        keys.close()
