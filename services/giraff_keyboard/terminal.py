"""The terminal: keys one by one and unechoed, a few lines of status, and everything as it was at the end."""

from __future__ import annotations

import contextlib
import os
import select
import shutil
import signal
import sys
import termios
import tty
from types import FrameType, TracebackType
from typing import Final, Self

from giraff_schemas.text import printable

_READ: Final = 4096
_PASTES_MARKED: Final = "\x1b[?2004h"
_PASTES_PLAIN: Final = "\x1b[?2004l"
_CLEAR_BELOW: Final = "\r\x1b[J"
_NO_CHARACTER: Final = b"\0"  # _POSIX_VDISABLE of Linux


class RawTerminal:
    """Standard input and output, which must be a terminal. A `Selectable`, so that a press wakes the loop."""

    def __init__(self) -> None:
        self._input = sys.stdin.fileno()
        self.is_gone = False
        """Its other end was closed, or another program has the keys: none can come any more."""
        self._has_slept = False

    def __enter__(self) -> Self:
        self._before = termios.tcgetattr(self._input)
        self._take_keys()
        signal.signal(signal.SIGHUP, signal.SIG_IGN)  # a closed window shows as `is_gone`, and is told to the robot
        signal.signal(signal.SIGCONT, self._on_continued)
        for number in (signal.SIGTTIN, signal.SIGTTOU):  # in the background: stopped without a last word to the robot
            signal.signal(number, signal.SIG_IGN)
        _write(_PASTES_MARKED)
        return self

    def _take_keys(self) -> None:
        termios.tcflush(self._input, termios.TCIFLUSH)  # what was typed before now is nobody's wish
        tty.setcbreak(self._input, termios.TCSANOW)
        attributes = termios.tcgetattr(self._input)
        attributes[0] &= ~(termios.IXON | termios.IXOFF)  # Ctrl-S would stop the program at its next line
        attributes[3] &= ~termios.IEXTEN
        attributes[3] |= termios.NOFLSH  # else Ctrl-C throws output away, under a thread that waits to write more
        for character in (termios.VSUSP, termios.VQUIT):  # Ctrl-Z, Ctrl-\: would leave the terminal as it is now
            attributes[6][character] = _NO_CHARACTER
        termios.tcsetattr(self._input, termios.TCSANOW, attributes)

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        with contextlib.suppress(OSError):  # it may be gone
            _write(_PASTES_PLAIN)
        self.restore()

    def restore(self) -> None:
        """Have keys read as before. Never waits: not for a terminal that takes nothing, as TCSAFLUSH would."""
        with contextlib.suppress(OSError, termios.error):  # it may be gone
            if not self._is_in_front:
                return  # the shell has set it for itself meanwhile
            termios.tcflush(self._input, termios.TCIFLUSH)  # what was typed here is nobody's command line
            termios.tcsetattr(self._input, termios.TCSANOW, self._before)

    @property
    def _is_in_front(self) -> bool:
        """The keys are this program's, not the shell's."""
        return os.tcgetpgrp(self._input) == os.getpgrp()

    def descriptor(self) -> int | None:
        return None if self.is_gone else self._input

    def read(self) -> bytes:
        """What has been typed since the last call. Never waits."""
        data = b""
        try:
            if self._has_slept:
                self._wake_up()
            if select.select((self._input,), (), (), 0.0)[0]:
                data = os.read(self._input, _READ)
                self.is_gone = not data
        except (OSError, termios.error):
            self.is_gone = True
        return data

    def show_anew(self) -> None:
        """The shell has had the screen."""
        _write(_PASTES_MARKED)

    def _wake_up(self) -> None:
        """A shell that had stopped this program has set the terminal as it likes, and SPACE would wait for a line."""
        self._has_slept = False
        if not self._is_in_front:
            self.is_gone = True
            return
        self._take_keys()
        self.show_anew()

    def _on_continued(self, number: int, frame: FrameType | None) -> None:
        del number, frame
        self._has_slept = True


class Terminal(RawTerminal):
    """Shows a few lines below the cursor."""

    def __init__(self) -> None:
        super().__init__()
        self._shown: list[str] = []

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        with contextlib.suppress(OSError):  # it may be gone
            _write("\n" * len(self._shown))
        super().__exit__(kind, error, trace)

    def show(self, lines: list[str]) -> None:
        """Replace the lines shown before."""
        width = shutil.get_terminal_size().columns
        fitting = [printable(line[: width - 1]) for line in lines]  # a line that wraps would scroll all away
        if fitting == self._shown or self.is_gone:
            return
        self._shown = fitting
        up = f"\x1b[{len(fitting) - 1}A" if len(fitting) > 1 else ""
        try:
            _write(_CLEAR_BELOW + "\n".join(fitting) + up + "\r")
        except OSError:
            self.is_gone = True


def _write(text: str) -> None:
    sys.stdout.write(text)
    sys.stdout.flush()
