"""The terminal, as another process has it: unechoed keys, and as it was before at every kind of end."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from tests.support.terminals import Screen, screen
from tests.support.waiting import wait

PROGRAM = """
import os, signal, sys
from types import SimpleNamespace as Some
from giraff_keyboard.terminal import Terminal
view = Some(topics=(), on_sample=None, draw=lambda _, text, now: Some(render=lambda: text))
with Terminal(view, None) as terminal:
    terminal.show(None, "ready", 0.0)
    while not terminal.is_gone:
        data = terminal.read()
        if data:
            terminal.show(None, repr(data), 0.0)
        if data == b"q":
            break
        if data == b"b":
            os.tcgetpgrp = lambda _: 0  # a shell has put it into the background
            os.kill(os.getpid(), signal.SIGCONT)
        if data == b"!":
            raise RuntimeError("broken")
sys.exit(7 if terminal.is_gone else 0)
"""


@contextmanager
def program(log: Path) -> Iterator[Screen]:
    with screen([sys.executable, "-c", PROGRAM], log) as shown:
        shown.wait_for("ready")
        yield shown


@pytest.mark.parametrize(("last", "status"), [(b"q", 0), (b"!", 1)], ids=["end", "exception"])
def test_it_is_restored_at_the_end_of_whatever_kind(last: bytes, status: int, tmp_path: Path) -> None:
    with program(tmp_path / "log") as shown:
        assert not shown.is_restored()
        shown.type(last)
        assert shown.process.wait(60.0) == status
        assert shown.is_restored()
        shown.wait_for("\x1b[?2004l")


def test_keys_come_one_by_one_and_unechoed_and_none_suspends_or_stalls(tmp_path: Path) -> None:
    with program(tmp_path / "log") as shown:
        for key in (b"w", b"\x1b[A", b"\x1a", b"\x1c", b"\x13", b"\x16", b"\r"):
            shown.type(key)
            shown.wait_for(repr(key if key != b"\r" else b"\n"))
        assert "w" not in shown.text.replace("b'w'", "")
        shown.type(b"q")
        assert shown.process.wait(60.0) == 0


def test_once_a_shell_has_had_the_terminal_keys_come_one_by_one_again(tmp_path: Path) -> None:
    """Ctrl-Z does nothing, but anybody may stop a program, and `fg` continues it."""
    with program(tmp_path / "log") as shown:
        shown.process.send_signal(signal.SIGSTOP)
        os.waitpid(shown.process.pid, os.WUNTRACED)
        shown.set_as_before()
        shown.type(b"w")
        shown.process.send_signal(signal.SIGCONT)
        wait(lambda: not shown.is_restored(), what="its own setting")
        shown.type(b" ")
        shown.wait_for(repr(b" "))
        assert "b'w" not in shown.text, "it was typed while nobody read"
        shown.type(b"q")
        assert shown.process.wait(60.0) == 0
        assert shown.is_restored()


def test_in_the_background_it_ends(tmp_path: Path) -> None:
    with program(tmp_path / "log") as shown:
        shown.type(b"b")
        assert shown.process.wait(60.0) == 7, (tmp_path / "log").read_text()


def test_a_closed_terminal_shows(tmp_path: Path) -> None:
    with program(tmp_path / "log") as shown:
        shown.hang_up()
        assert shown.process.wait(60.0) == 7, (tmp_path / "log").read_text()


def test_without_a_terminal_it_says_so() -> None:
    run = subprocess.run(
        [sys.executable, "-m", "giraff_node", "keyboard"],
        check=False,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
    )
    assert run.returncode == 2
    assert "terminal" in run.stderr
    assert "Traceback" not in run.stderr
