"""How far long work has come is shown to a person at a terminal, and to nobody else."""

import contextlib
import os
import pty
import re
import sys
from collections.abc import Iterator

import pytest

from giraff_mcap.reading import Recording
from giraff_tools.terminal import progress
from giraff_tools.terminal.progress import Progress
from tests.rules.repository import ROOT


class Terminal:
    """A terminal of its own."""

    def __init__(self) -> None:
        self._ours, theirs = pty.openpty()
        os.set_blocking(self._ours, False)
        self._stream = os.fdopen(theirs, "w")

    def stand_in(self, monkeypatch: pytest.MonkeyPatch) -> None:
        """Take the place of standard error. Pytest would undo it at the end of a fixture."""
        monkeypatch.setattr(sys, "stderr", self._stream)

    def read(self) -> str:
        self._stream.flush()
        told = b""
        with contextlib.suppress(BlockingIOError):
            while data := os.read(self._ours, 65536):
                told += data
        return told.decode()

    def close(self) -> None:
        self._stream.close()
        os.close(self._ours)


@pytest.fixture
def terminal(monkeypatch: pytest.MonkeyPatch) -> Iterator[Terminal]:
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("COLUMNS", "80")
    monkeypatch.setattr(progress, "_AFTER", 0.0)
    monkeypatch.setattr(progress, "_EVERY", 0.0)
    made = Terminal()
    yield made
    made.close()


def test_a_terminal_shows_the_share_and_its_line_is_free_before_anything_else_is_printed(
    terminal: Terminal, monkeypatch: pytest.MonkeyPatch
) -> None:
    terminal.stand_in(monkeypatch)
    with Progress("repairing") as bar:
        bar.move(0.25)
        assert re.search(r"repairing.* 25%.*-:--:--", terminal.read())
        bar.hide()
        assert terminal.read().endswith("\n\r\x1b[1A\x1b[2K"), "the line is free"
        bar.move(1.5)
        assert "100%" in (told := terminal.read())
    assert "\x1b[?25" not in told + terminal.read(), "a signal that ends the command must not leave the cursor hidden"


@pytest.mark.parametrize(("shown", "term"), [(False, "xterm"), (True, "dumb")])
def test_nobody_else_is_shown_anything(
    terminal: Terminal, monkeypatch: pytest.MonkeyPatch, *, shown: bool, term: str
) -> None:
    monkeypatch.setenv("TERM", term)
    terminal.stand_in(monkeypatch)
    with Progress("repairing", shown=shown) as bar:
        bar.move(0.5)
    assert terminal.read() == ""


def test_a_recording_knows_how_much_of_it_was_heard_before_a_moment() -> None:
    recording = Recording(ROOT / "tests" / "unit" / "replay" / "data" / "drive.mcap")
    heard = [sample.heard_ns for sample in recording.samples()]
    assert recording.bounds_ns == (min(heard), max(heard))
    middle = (min(heard) + max(heard)) // 2
    shares = [recording.share_before(at) for at in (0, middle, max(heard) + 1)]
    assert shares == [0.0, pytest.approx(0.5, abs=1e-6), 1.0]
