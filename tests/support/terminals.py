"""A program in a terminal of its own, with somebody who types and reads what it shows."""

import codecs
import os
import pty
import subprocess
import sys
import termios
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path

from tests.support.waiting import wait

_IN_ITS_TERMINAL = """
import fcntl, os, sys, termios
fcntl.ioctl(0, termios.TIOCSCTTY, 0)
os.execv(sys.argv[1], sys.argv[1:])
"""
"""Makes standard input the controlling terminal, so that Ctrl-C and a hang-up are signals."""


class Screen:
    """The program, and the other end of its terminal."""

    def __init__(self, command: list[str], log: Path, environment: Mapping[str, str]) -> None:
        """`log` takes its standard error."""
        self._log = log
        self._master, self._slave = pty.openpty()
        self._before = termios.tcgetattr(self._slave)
        os.set_blocking(self._master, False)
        self._decoder = codecs.getincrementaldecoder("utf-8")()  # a read ends anywhere
        self.text = ""
        """All that has been shown since the last `forget`."""
        with log.open("wb") as errors:
            self.process = subprocess.Popen(
                [sys.executable, "-c", _IN_ITS_TERMINAL, *command],
                stdin=self._slave,
                stdout=self._slave,
                stderr=errors,
                env=dict(environment) | {"COLUMNS": "200"},
                start_new_session=True,
            )

    def read(self) -> str:
        """Take what has been shown meanwhile; all since the last `forget`."""
        with suppress(BlockingIOError):
            while True:
                self.text += self._decoder.decode(os.read(self._master, 4096))
        return self.text

    def forget(self) -> None:
        """From here on only what is shown anew counts."""
        self.read()
        self.text = ""

    def wait_for(self, text: str, seconds: float = 10.0) -> None:
        wait(
            lambda: text in self.read(),
            seconds,
            what=lambda: f"{text!r} is not shown: {self.text[-2000:]}\n{self._log.read_text()}",
            every=0.01,
        )

    def ended(self, seconds: float) -> int:
        """Wait for its end, and read on meanwhile: what nobody reads holds it up. Its exit code."""
        wait(lambda: (self.read(), self.process.poll())[1] is not None, seconds, what="it does not end")
        return self.process.returncode

    def type(self, data: bytes) -> None:
        os.write(self._master, data)

    def fill(self) -> None:
        """Write into it, beside the program, until it takes no more: nobody reads it."""
        beside = os.open(os.ttyname(self._slave), os.O_WRONLY | os.O_NOCTTY | os.O_NONBLOCK)
        with suppress(BlockingIOError):
            while True:
                os.write(beside, bytes(1024))
        os.close(beside)

    def hang_up(self) -> None:
        """Close the terminal, as a closed window does."""
        os.close(self._slave)
        os.close(self._master)
        self._master, self._slave = pty.openpty()  # for `close`

    def is_restored(self) -> bool:
        """The terminal is set as it was before the program."""
        return termios.tcgetattr(self._slave) == self._before

    def set_as_before(self) -> None:
        """As a shell does that has stopped the program."""
        termios.tcsetattr(self._slave, termios.TCSANOW, self._before)

    def close(self) -> None:
        self.process.kill()
        self.process.wait()
        os.close(self._master)
        os.close(self._slave)


@contextmanager
def screen(command: list[str], log: Path, environment: Mapping[str, str] = os.environ) -> Iterator[Screen]:
    """The program ends with the block."""
    shown = Screen(command, log, environment)
    try:
        yield shown
    finally:
        shown.close()
