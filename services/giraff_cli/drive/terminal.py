"""The terminal of `giraff drive`: keys as they come, and a picture on the terminal's second page.

The picture is drawn in a thread of its own. It takes some ms, more on a slow machine, and a terminal that takes nothing
holds it up for good: neither may make a key late, an emergency stop, or the end.
"""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Callable
from types import TracebackType
from typing import Final

from rich.console import RenderableType
from rich.control import Control
from rich.live import Live
from rich.text import Text

from giraff_cli.drive.picture import DrivePicture
from giraff_cli.terminal.page import CleanConsole
from giraff_keyboard.terminal import RawTerminal

_PICTURES_HZ: Final = 5
_LEAVES_WITHIN: Final = 1.0  # s


class DriveTerminal(RawTerminal):
    """As long as its block lasts; it is as it was afterwards."""

    def __init__(self, on_failure: Callable[[BaseException], None]) -> None:
        """`on_failure`: told in another thread of what keeps the picture from being drawn: an old one must not stay."""
        super().__init__()
        self.is_stuck = False
        """It took nothing in the end, and waits with whatever would write to it."""
        self._picture: DrivePicture | None = None
        self._page = _Page(self._newest, on_failure)

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        leaving = threading.Thread(target=self._leave, daemon=True)
        leaving.start()
        leaving.join(_LEAVES_WITHIN)
        self.is_stuck = leaving.is_alive()
        if self.is_stuck:
            self.restore()

    def show(self, picture: DrivePicture) -> None:
        """Draw it from now on."""
        self._picture = picture
        if self._page.is_started:
            return
        try:
            self._page.start()
        except OSError:
            self.is_gone = True

    def show_anew(self) -> None:
        self._page.has_lost_page = True

    def _leave(self) -> None:
        with contextlib.suppress(OSError):  # it may be gone
            self._page.stop()
        super().__exit__(None, None, None)

    def _newest(self) -> RenderableType:
        return Text() if self._picture is None else self._picture.render()


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
            super().refresh()
        except OSError:
            pass  # it is gone: whoever reads the keys sees that, and ends
        except Exception as error:  # noqa: BLE001  Rich's thread would end, and an old picture stay
            self._on_failure(error)
