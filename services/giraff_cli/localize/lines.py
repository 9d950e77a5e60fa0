"""What localization says, where there is no terminal: a line when it changes, or each pose for programs."""

from __future__ import annotations

from typing import Final, Protocol

from giraff_cli.localize.view import PoseView, document
from giraff_schemas.text import printable
from giraff_tools.terminal.screen import Terminal, open_screen
from giraff_tools.terminal.text import json_line

_QUIET: Final = 1.0  # s between two lines that only say that it has moved


class PoseScreen(Protocol):
    """Raises OSError from `show` when nobody can see it any more."""

    def show(self, view: PoseView) -> None: ...

    def close(self) -> None: ...


class ChangedLines:
    """A line at once when the state changes, and one a second while only the rest does."""

    def __init__(self) -> None:
        self._told: tuple[str, ...] = ()
        self._words = ""
        self._next = 0.0

    def show(self, view: PoseView) -> None:
        if view.words == self._words or (view.told == self._told and view.elapsed < self._next):
            return
        self._told, self._words, self._next = view.told, view.words, view.elapsed + _QUIET
        print(printable(view.line()), flush=True)

    def close(self) -> None:
        """Nothing is left to restore."""


class JsonLines:
    """Each pose once, as it comes."""

    def __init__(self) -> None:
        self._last: tuple[str, int] | None = None

    def show(self, view: PoseView) -> None:
        if view.pose is None:
            return
        pose = view.pose.sample
        if (pose.instance, pose.seq) != self._last:
            self._last = pose.instance, pose.seq
            print(json_line(document(view.robot, pose)), flush=True)

    def close(self) -> None:
        """Nothing is left to restore."""


def screen_of(*, as_json: bool) -> PoseScreen:
    """What standard output is good for, and was asked for."""
    if as_json:
        return JsonLines()
    screen = open_screen(page=False)
    return screen if isinstance(screen, Terminal) else ChangedLines()
