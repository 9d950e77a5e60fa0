"""Where a run is shown: a live view in a terminal, else one line a second."""

from __future__ import annotations

import contextlib
import io
import os
import re
import sys
from typing import Final, Protocol

from rich.console import Console
from rich.live import Live

from giraff_cli.line import line
from giraff_cli.telemetry import Snapshot
from giraff_cli.view import Frame, view

_PICTURE_COLUMNS: Final = 100
_WEB_FONTS: Final = re.compile(r"\s*@font-face \{.*?\}", re.DOTALL)


class Screen(Protocol):
    """Raises OSError from `show` when nobody can see it any more."""

    def show(self, snapshot: Snapshot, frame: Frame) -> None: ...

    def close(self) -> None: ...


class Terminal:
    """The live view on the terminal's second page, so that the first is as it was when this closes."""

    def __init__(self) -> None:
        self._live = Live(console=Console(highlight=False), screen=True, auto_refresh=False)
        self._live.start()

    def show(self, snapshot: Snapshot, frame: Frame) -> None:
        self._live.update(view(snapshot, frame), refresh=True)

    def close(self) -> None:
        with contextlib.suppress(OSError):  # the terminal may be gone
            self._live.stop()


class Lines:
    """A line in each second of the run."""

    def __init__(self) -> None:
        self._next = 0.0

    def show(self, snapshot: Snapshot, frame: Frame) -> None:
        if frame.elapsed >= self._next:
            self._next = int(frame.elapsed) + 1.0
            print(line(snapshot, frame.elapsed), flush=True)

    def close(self) -> None:
        """Nothing is left to restore."""


class Nobody:
    """Nobody watches."""

    def show(self, snapshot: Snapshot, frame: Frame) -> None:
        """Nothing to do."""

    def close(self) -> None:
        """Nothing to restore."""


def open_screen() -> Screen:
    """What standard output is good for."""
    if sys.stdout.isatty() and os.environ.get("TERM", "dumb") != "dumb":
        return Terminal()
    return Lines()


def say(text: str) -> None:
    """Print what a person should read after all. Whoever reads the output may have gone: that ends no run early."""
    try:
        print(text, flush=True)
    except OSError:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, sys.stdout.fileno())  # or Python complains at exit of what it cannot flush
        os.close(nowhere)


def picture(snapshot: Snapshot, frame: Frame) -> str:
    """The live view as SVG, with the reader's own fonts."""
    console = Console(
        file=io.StringIO(), record=True, width=_PICTURE_COLUMNS, force_terminal=True, color_system="truecolor"
    )
    console.print(view(snapshot, frame))
    return _WEB_FONTS.sub("", console.export_svg(title="giraff run"))
