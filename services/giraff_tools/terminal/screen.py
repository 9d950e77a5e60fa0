"""Where a robot is shown: a live view in a terminal, else one line a second."""

import contextlib
import io
import re
import select
import sys
from typing import Final, Protocol

from rich.console import RenderableType
from rich.live import Live

from giraff_schemas.text import printable, printable_lines
from giraff_telemetry.console import CleanConsole
from giraff_tools.terminal.output import discard_stdout, is_drawn_on

_PICTURE_COLUMNS: Final = 100
_PIECE: Final = select.PIPE_BUF // 4
"""Characters that a pipe takes without delay, of four bytes at most, where it takes any."""
_WEB_FONTS: Final = re.compile(r"\s*@font-face \{.*?\}", re.DOTALL)


class View(Protocol):
    """What is to be seen at one moment."""

    @property
    def elapsed(self) -> float:
        """s since it began."""
        ...

    def render(self) -> RenderableType: ...

    def line(self) -> str: ...


class Screen(Protocol):
    """Raises OSError from `show` when nobody can see it any more."""

    def show(self, view: View) -> None: ...

    def close(self) -> None: ...


class Terminal:
    """The live view on the terminal's second page, so that the first is as it was when this closes.

    Without a `page` it is at the end of the first, and gone when this closes.
    """

    def __init__(self, *, page: bool = True) -> None:
        self._live = Live(console=CleanConsole(highlight=False), screen=page, transient=not page, auto_refresh=False)
        self._live.start()

    def show(self, view: View) -> None:
        if _takes_more():
            self._live.update(view.render(), refresh=True)

    def close(self) -> None:
        with contextlib.suppress(OSError):  # the terminal may be gone
            self._live.stop()


class LineScreen:
    """A line in each second. Its end is dropped where the reader pauses until this closes."""

    def __init__(self) -> None:
        self._next = 0.0
        self._rest = ""
        """The end of the last line, for which there was no room."""

    def show(self, view: View) -> None:
        if not self._rest and view.elapsed >= self._next and _takes_more():
            self._next = int(view.elapsed) + 1.0
            self._rest = printable(view.line()) + "\n"
        self._print()

    def close(self) -> None:
        self._print()

    def _print(self) -> None:
        while self._rest and _takes_more():
            piece, self._rest = self._rest[:_PIECE], self._rest[_PIECE:]
            print(piece, end="", flush=True)


class NullScreen:
    """Nobody watches."""

    def show(self, view: View) -> None:
        """Nothing to do."""

    def close(self) -> None:
        """Nothing to restore."""


def open_screen(*, page: bool = True) -> Screen:
    """What standard output is good for. `page`: of a terminal, its second one."""
    if is_drawn_on(sys.stdout):
        return Terminal(page=page)
    return LineScreen()


def say(text: str) -> None:
    """Print what a person should read after all. Whoever reads the output may have gone: that ends no run early."""
    try:
        print(printable_lines(text), flush=True)
    except OSError:
        discard_stdout()


def as_svg(picture: RenderableType, title: str = "giraff run", columns: int = _PICTURE_COLUMNS) -> str:
    """A live view as SVG, with the reader's own fonts."""
    console = CleanConsole(
        file=io.StringIO(), record=True, width=columns, force_terminal=True, color_system="truecolor"
    )
    console.print(picture)
    return _WEB_FONTS.sub("", console.export_svg(title=title))


def _takes_more() -> bool:
    """Whether standard output takes more without delay. A paused reader must not hold up what else is to be done."""
    return bool(select.select([], [sys.stdout], [], 0.0)[1])
