"""How `giraff run` ends: in a terminal, killed, and while it has hardly begun."""

import contextlib
import fcntl
import os
import pty
import re
import signal
import struct
import termios
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.support.process_robot import PATIENCE
from tests.support.runs import Command, command_in, line_of
from tests.support.waiting import wait

ROWS, COLUMNS = 24, 80


@pytest.fixture
def command(tmp_path: Path) -> Iterator[Command]:
    with command_in(tmp_path) as made:
        yield made


def test_being_killed_it_takes_everything_along(command: Command) -> None:
    with command.start("--boards", "host") as process:
        line_of(process, " | ")
        process.kill()
    wait(lambda: not command.pids(), PATIENCE, what="the end of all children")
    assert list(command.left.iterdir()), "nobody could remove it"
    code, _, err = command.run("--boards", "host", "--for", "0.1")
    assert (code, err) == (0, "")
    assert command.leaves_nothing(), "not even what the killed one left"


@pytest.mark.parametrize(("number", "later"), [(signal.SIGINT, 0.0), (signal.SIGTERM, 0.1)])
def test_a_signal_at_its_very_start_ends_it_without_a_traceback(
    command: Command, number: signal.Signals, later: float
) -> None:
    """What the interpreter itself says before it has come to our first line is not ours to change."""
    with command.start() as process:
        maps = Path(f"/proc/{process.pid}/maps")
        wait(
            lambda: re.search("lib-dynload|site-packages", maps.read_text(encoding="utf-8")) is not None,
            PATIENCE,
            what="its first import",
        )
        time.sleep(later)
        process.send_signal(number)
        _, err = process.communicate(timeout=PATIENCE)
    assert err == ""
    assert process.returncode in (0, -number)
    assert not command.pids()


class Window:
    """A terminal of 80 by 24 with the command in it."""

    def __init__(self, command: Command, *options: str) -> None:
        self.ours, theirs = pty.openpty()
        fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", ROWS, COLUMNS, 0, 0))
        self.before = termios.tcgetattr(theirs)
        command.environment["TERM"] = "xterm-256color"
        self.process = command.start(
            *options, stdin=theirs, stdout=theirs, stderr=theirs, preexec_fn=self._control, start_new_session=True
        )
        self._theirs = theirs
        os.set_blocking(self.ours, False)
        self.text = ""

    @staticmethod
    def _control() -> None:
        """Make it the terminal that Ctrl-C is typed into."""
        fcntl.ioctl(0, termios.TIOCSCTTY, 0)

    def shows(self, pattern: str) -> bool:
        with contextlib.suppress(BlockingIOError):
            while data := os.read(self.ours, 65536):
                self.text += data.decode(errors="replace")
        return re.search(pattern, self.text) is not None

    def settings(self) -> list[Any]:
        return termios.tcgetattr(self._theirs)

    def close(self) -> None:
        self.process.kill()
        self.process.wait()
        os.close(self.ours)
        os.close(self._theirs)


def test_in_a_terminal_there_is_a_live_view_and_ctrl_c_gives_the_terminal_back(command: Command) -> None:
    picture = command.directory / "picture.svg"
    window = Window(command, "--boards", "host", "--picture", str(picture))
    try:
        wait(lambda: window.shows(r"odom +\d+\.\d"), PATIENCE, what="the rate of odom")
        os.write(window.ours, b"\x03")
        wait(lambda: window.shows("rates in Hz") and window.process.poll() is not None, PATIENCE, what="the end")
        assert window.process.returncode == 0
        on, off = window.text.index("\x1b[?1049h"), window.text.rindex("\x1b[?1049l")
        assert on < window.text.index("GUARD") < off < window.text.index("distance")
        assert window.text.rindex("\x1b[?25h") > window.text.rindex("\x1b[?25l")
        assert window.settings() == window.before
    finally:
        window.close()
    assert "SERVICES" in picture.read_text()
    assert command.leaves_nothing()
