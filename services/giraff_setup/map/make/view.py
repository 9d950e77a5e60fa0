"""Shows a plan while it grows: drawn in a terminal, else a line now and then, or objects for programs."""

import math
import re
from dataclasses import dataclass
from typing import Final

import msgspec
from rich.console import RenderableType

from giraff_maps.floor_plan import FloorPlan
from giraff_schemas.localization import MapPose
from giraff_schemas.text import printable
from giraff_tools.terminal.floor import plan_and_words
from giraff_tools.terminal.screen import Screen, Terminal, View, open_screen
from giraff_tools.terminal.text import json_line

_FIGURES: Final = re.compile(r"\d+")
_QUIET: Final = 3.0  # s between two lines
_SAME: Final = 15.0  # s between two that differ in figures alone
_TOLD: Final = ("map", "state", "reason", "x", "y", "yaw")
"""Fields of the pose that programs are told."""


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
    as_json: bool
    """Programs read its lines."""

    def render(self) -> RenderableType:
        style = "green" if self.pose.state == "localized" else "yellow"
        return plan_and_words(self.walls, self.pose, printable(f"{self.robot} | {self.words}"), style)

    def line(self) -> str:
        if not self.as_json:
            return printable(f"{self.elapsed:6.1f} s | {self.robot} | {self.words}")
        pose = msgspec.to_builtins(self.pose)
        return json_line({"robot": self.robot, **{name: pose[name] for name in _TOLD}, "way": self.way})


class ChangedLines:
    """A line each few seconds, and more seldom where nothing but figures has changed."""

    def __init__(self, same: float) -> None:
        """`same`: s between two lines that differ in figures alone."""
        self._same = same
        self._told = ""
        self._last = -math.inf

    def show(self, view: View) -> None:
        line = view.line()
        told = _FIGURES.sub("", line)
        if view.elapsed - self._last >= (self._same if told == self._told else _QUIET):
            self._told, self._last = told, view.elapsed
            print(line, flush=True)

    def close(self) -> None:
        """Nothing is left to restore."""


def screen_of(*, as_json: bool) -> Screen:
    """Return what standard output is good for, and was asked for."""
    if as_json:
        return ChangedLines(_QUIET)
    screen = open_screen(page=False)
    return screen if isinstance(screen, Terminal) else ChangedLines(_SAME)
