"""The terminal: keys one by one and unechoed, a picture on its second page, and everything as it was at the end.

The picture is drawn in a thread of its own. It takes some ms, more on a slow machine, and a terminal that takes nothing
holds it up for good: neither may make a key late, an emergency stop, or the end.
"""

import contextlib
import os
import select
import signal
import sys
import termios
import threading
import tty
from collections.abc import Callable
from types import FrameType, TracebackType
from typing import Final, Self

from rich.console import RenderableType
from rich.control import Control
from rich.live import Live
from rich.text import Text

from giraff_keyboard.picture import DrivePicture, DriveView
from giraff_keyboard.policy import KeyboardPolicy
from giraff_schemas.trouble import Trouble
from giraff_telemetry.console import CleanConsole

_READ: Final = 4096
_PASTES_MARKED: Final = "\x1b[?2004h"
_PASTES_PLAIN: Final = "\x1b[?2004l"
_NO_CHARACTER: Final = b"\0"  # _POSIX_VDISABLE of Linux
_PICTURES_HZ: Final = 5
_LEAVES_WITHIN: Final = 1.0  # s


class Terminal:
    """Standard input and output, which must be a terminal, as long as its block lasts.

    A `Selectable`, so that a press wakes the loop.
    """

    def __init__(self, view: DriveView, on_failure: Callable[[BaseException], None]) -> None:
        """`on_failure`: told in another thread of what keeps the picture from being drawn: an old one must not stay."""
        self.topics, self.on_sample = view.topics, view.on_sample
        self._view = view
        self._input = sys.stdin.fileno()
        self.is_gone = False
        """Its other end was closed, or another program has the keys: none can come any more."""
        self.is_stuck = False
        """It took nothing in the end, and waits with whatever would write to it."""
        self._has_slept = False
        self._picture: DrivePicture | None = None
        self._page = _Page(self._newest, on_failure)

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
        leaving = threading.Thread(target=self._leave, daemon=True)
        leaving.start()
        leaving.join(_LEAVES_WITHIN)
        self.is_stuck = leaving.is_alive()
        if self.is_stuck:
            self._restore()

    def _leave(self) -> None:
        with contextlib.suppress(OSError):  # it may be gone
            self._page.stop()
        with contextlib.suppress(OSError):
            _write(_PASTES_PLAIN)
        self._restore()

    def _restore(self) -> None:
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

    def show(self, policy: KeyboardPolicy, stop: Trouble, now: float) -> None:
        """Draw what is to be seen from now on. `stop`: what became of one, or of its release, asked for here."""
        self._picture = self._view.draw(policy, stop, now)
        if self._page.is_started:
            return
        try:
            self._page.start()
        except OSError:
            self.is_gone = True

    def _newest(self) -> RenderableType:
        return Text() if self._picture is None else self._picture.render()

    def _wake_up(self) -> None:
        """A shell that had stopped this program has set the terminal as it likes, and SPACE would wait for a line."""
        self._has_slept = False
        if not self._is_in_front:
            self.is_gone = True
            return
        self._take_keys()
        self._page.has_lost_page = True

    def _on_continued(self, number: int, frame: FrameType | None) -> None:
        del number, frame
        self._has_slept = True


class _Page(Live):
    def __init__(self, draw: Callable[[], RenderableType], on_failure: Callable[[BaseException], None]) -> None:
        super().__init__(
            console=CleanConsole(highlight=False),
            screen=True,
            get_renderable=draw,
            refresh_per_second=_PICTURES_HZ,
            redirect_stdout=False,
            redirect_stderr=False,
        )
        self._on_failure = on_failure
        self.has_lost_page = False
        """The shell has had the screen."""

    def refresh(self) -> None:
        try:
            if self.has_lost_page:
                self.has_lost_page = False
                self.console.control(Control.alt_screen(enable=True), Control.show_cursor(show=False))
                _write(_PASTES_MARKED)
            super().refresh()
        except OSError:
            pass  # it is gone: whoever reads the keys sees that, and ends
        except Exception as error:  # noqa: BLE001  Rich's thread would end, and an old picture stay
            self._on_failure(error)


def _write(text: str) -> None:
    sys.stdout.write(text)
    sys.stdout.flush()
