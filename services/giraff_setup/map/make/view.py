"""Shows a plan while it grows: drawn in a terminal, else a line now and then, or objects for programs."""

import shutil
from dataclasses import dataclass
from functools import lru_cache
from typing import Final, Protocol

import msgspec
from rich.console import Group, RenderableType
from rich.text import Text

from giraff_maps.floor_plan import FloorPlan
from giraff_schemas.localization import MapPose
from giraff_schemas.text import printable
from giraff_tools.terminal.dots import takes_dots
from giraff_tools.terminal.floor import FloorDrawing
from giraff_tools.terminal.screen import Terminal, open_screen
from giraff_tools.terminal.text import json_line

_LARGEST: Final = 80, 24
"""Columns and lines of the floor plan."""
_WORDS: Final = 5
"""Lines of the terminal that the plan leaves to the words."""
_QUIET: Final = 3.0  # s between two lines
_drawing = lru_cache(maxsize=2)(FloorDrawing)


@dataclass(frozen=True)
class GrowingPlan:
    """For any screen."""

    robot: str
    elapsed: float
    """s since it began."""
    words: str
    pose: MapPose
    walls: FloorPlan | None
    """None: there are none yet."""
    way: float
    """m driven."""
    loops: int

    def render(self) -> RenderableType:
        style = "green" if self.pose.state == "localized" else "yellow"
        words = Text(printable(f"{self.robot} | {self.words}"), style)
        if self.walls is None:
            return words
        columns, lines = shutil.get_terminal_size()
        size = min(columns - 1, _LARGEST[0]), max(_WORDS, min(lines - _WORDS, _LARGEST[1]))
        return Group(_drawing(self.walls, *size, dots=takes_dots()).draw(self.pose, style), words)

    def line(self) -> str:
        return printable(f"{self.elapsed:6.1f} s | {self.robot} | {self.words}")

    def document(self) -> str:
        pose = self.pose
        where = {"x": pose.x, "y": pose.y, "yaw": pose.yaw}
        told = {"robot": self.robot, "state": pose.state, "reason": msgspec.to_builtins(pose.reason), **where}
        return json_line(told | {"way": self.way, "loops": self.loops})


class PlanScreen(Protocol):
    """Raises OSError from `show` when nobody can see it any more."""

    def show(self, view: GrowingPlan) -> None: ...

    def close(self) -> None: ...


class ChangedLines:
    """A line when what is said has changed, and some seconds have gone by."""

    def __init__(self, *, as_json: bool) -> None:
        self._as_json = as_json
        self._words = ""
        self._next = 0.0

    def show(self, view: GrowingPlan) -> None:
        if view.elapsed >= self._next and view.words != self._words:
            self._words, self._next = view.words, view.elapsed + _QUIET
            print(view.document() if self._as_json else view.line(), flush=True)

    def close(self) -> None:
        """Nothing is left to restore."""


def screen_of(*, as_json: bool) -> PlanScreen:
    """Return what standard output is good for, and was asked for."""
    if not as_json:
        screen = open_screen(page=False)
        if isinstance(screen, Terminal):
            return screen
    return ChangedLines(as_json=as_json)
