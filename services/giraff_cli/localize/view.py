"""What localization says at one moment: a line for people, an object for programs."""

from __future__ import annotations

import re
import shutil
from dataclasses import dataclass
from functools import cache
from typing import Any, Final

import msgspec
from rich.console import Group, RenderableType
from rich.text import Text

from giraff_core.latest import Latest
from giraff_maps.floor_plan import FloorPlan
from giraff_schemas.localization import MapPose
from giraff_schemas.text import printable
from giraff_telemetry.localization import pose_text
from giraff_tools.terminal.dots import takes_dots
from giraff_tools.terminal.floor import FloorDrawing

_FIGURES: Final = re.compile(r"\d+")
_STYLE: Final = {"localized": "green", "told": "yellow", "ambiguous": "yellow", "lost": "red", "no_map": "red"}
_LARGEST: Final = 80, 24
"""Columns and lines of the floor plan."""
_WORDS: Final = 5
"""Lines of the terminal that the plan leaves to the words."""


@dataclass(frozen=True)
class PoseView:
    """For any screen."""

    robot: str
    elapsed: float
    """s since it began."""
    pose: Latest[MapPose] | None
    """None: nothing was heard as yet."""
    plan: FloorPlan | None = None
    """Floor plan that a terminal shows. None: it shows the line alone."""

    @property
    def told(self) -> tuple[str, ...]:
        """What is worth a line at once when it changes: of a reason not its figures."""
        pose = self.pose
        if pose is None or not pose.fresh:
            return ("heard" if pose is not None else "unheard",)
        return "speaks", pose.sample.state, _FIGURES.sub("", str(pose.sample.reason)), pose.sample.map

    @property
    def words(self) -> str:
        pose = self.pose
        if pose is None:
            return f"{self.robot} | waiting for localization to speak"
        if not pose.fresh:
            return f"{self.robot} | localization is not heard for {pose.age:.0f} s; check that giraff_localization runs"
        return printable(f"{self.robot} | {pose_text(pose.sample)}")

    def render(self) -> RenderableType:
        pose = self.pose.sample if self.pose is not None and self.pose.fresh else None
        style = "yellow" if pose is None else _STYLE[pose.state]
        words = Text(self.words, style)
        if self.plan is None:
            return words
        columns, lines = shutil.get_terminal_size()
        size = min(columns - 1, _LARGEST[0]), max(_WORDS, min(lines - _WORDS, _LARGEST[1]))
        return Group(_drawing(self.plan, *size, dots=takes_dots()).draw(pose, style), words)

    def line(self) -> str:
        return f"{self.elapsed:6.1f} s | {self.words}"


_drawing = cache(FloorDrawing)
"""Drawings of one plan that are kept, in few sizes of a terminal."""


def document(robot: str, pose: MapPose) -> dict[str, Any]:
    """A pose for programs: m and rad."""
    x_sd, y_sd, yaw_sd = pose.standard_deviations
    deviations = {"x": x_sd, "y": y_sd, "yaw": yaw_sd}
    return {"robot": robot, **msgspec.to_builtins(pose), "standard_deviations": deviations}
