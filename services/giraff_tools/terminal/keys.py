"""Keys that are typed beside a live view, one by one and unechoed."""

import contextlib
import os
import select
import sys
import termios
import tty
from typing import Any


class Keys:
    """Reads standard input while that is this program's terminal. Ctrl-C stays a signal.

    A shell may have the terminal meanwhile: a program in the background that read it would be stopped.
    """

    def __init__(self) -> None:
        self._input = sys.stdin.fileno()
        self._before: list[Any] | None = None
        """The terminal's settings at the start. None: nothing has changed them yet."""
        self.are_heard = False
        """At the last look the terminal was this program's."""

    def read(self) -> str:
        """Return what was typed since the last call. Never waits; without a terminal it is nothing."""
        self.are_heard = False
        with contextlib.suppress(OSError, termios.error):  # it is no terminal, or is gone
            if os.tcgetpgrp(self._input) != os.getpgrp():
                return ""
            self.are_heard = True
            now = termios.tcgetattr(self._input)
            if now[3] & termios.ICANON:  # at first, and after a shell has had it
                self._before = self._before or now
                tty.setcbreak(self._input, termios.TCSANOW)
            if select.select([self._input], [], [], 0.0)[0]:
                return os.read(self._input, 4096).decode(errors="replace")
        return ""

    def close(self) -> None:
        """Leave the terminal as it was. What was typed here is nobody's command line."""
        with contextlib.suppress(OSError, termios.error):
            if self._before is not None and os.tcgetpgrp(self._input) == os.getpgrp():
                termios.tcflush(self._input, termios.TCIFLUSH)
                termios.tcsetattr(self._input, termios.TCSANOW, self._before)
