"""A question at a terminal: what is typed counts line by line, and meanwhile something is shown."""

import io
import os
import pty
from collections.abc import Iterator
from typing import TextIO

import pytest

from giraff_tools.terminal.human import NobodyError, Terminal


class Typist:
    """The other end of a terminal."""

    def __init__(self, end: int, typed: TextIO) -> None:
        self.end = end
        self.typed = typed

    def type(self, text: str) -> None:
        os.write(self.end, text.encode())

    def shown(self) -> str:
        return os.read(self.end, 65536).decode()

    def leave(self) -> None:
        os.close(self.end)
        self.end = -1


@pytest.fixture
def typist() -> Iterator[Typist]:
    end, terminal = pty.openpty()
    with os.fdopen(terminal) as typed:
        it = Typist(end, typed)
        yield it
        if it.end >= 0:
            it.leave()


def nothing() -> str:
    return ""


def test_lines_that_come_at_once_answer_one_question_each(typist: Typist) -> None:
    terminal = Terminal(typist.typed, io.StringIO())
    typist.type(" Again \n5,012\n")
    assert [terminal.ask("?", nothing), terminal.ask("?", nothing)] == ["again", "5,012"]


def test_meanwhile_goes_on_until_the_line_is_complete(typist: Typist) -> None:
    terminal = Terminal(typist.typed, io.StringIO())
    calls: list[int] = []

    def meanwhile() -> str:
        calls.append(1)
        if len(calls) == 3:
            typist.type("yes\n")
        return ""

    assert terminal.ask("?", meanwhile) == "yes"
    assert len(calls) == 3


def test_nobody_is_there_any_more(typist: Typist) -> None:
    terminal = Terminal(typist.typed, io.StringIO())
    typist.leave()
    with pytest.raises(NobodyError):
        terminal.ask("?", nothing)


def test_what_goes_on_is_shown_on_one_line(typist: Typist) -> None:
    texts = ["0.1 m", "0.1 m", "0.2 m", "0.2 m"]
    with os.fdopen(os.dup(typist.typed.fileno()), "w") as shown:
        terminal = Terminal(typist.typed, shown)

        def meanwhile() -> str:
            if len(texts) == 1:
                typist.type("\n")
            return texts.pop(0)

        terminal.ask("Drive:", meanwhile)
    assert typist.shown().startswith("Drive: \r\n0.1 m\r\x1b[K0.2 m")


def test_a_pipe_is_spared_it(typist: Typist) -> None:
    shown = io.StringIO()
    typist.type("\n")
    Terminal(typist.typed, shown).ask("Drive:", lambda: "0.1 m")
    assert shown.getvalue() == "Drive: "
