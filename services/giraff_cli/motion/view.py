"""A motion as whoever asked for it sees it: a bar in a terminal, a line, and how it ended."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Final

import msgspec
from rich.console import RenderableType
from rich.progress_bar import ProgressBar
from rich.table import Table
from rich.text import Text

from giraff_core.motion.result import MotionResult, way_of
from giraff_schemas.localization import MapPose
from giraff_schemas.motion import MotionState
from giraff_schemas.text import printable
from giraff_telemetry.localization import sigma_of

_BAR: Final = 24  # characters
_LEAST: Final = 1e-6
_HEADS: Final = {
    "blocked": "BLOCKED",
    "cancelled": "stopped",
    "lost_lease": "ended, somebody else drives",
    "time_limit": "ended, its time was over",
    "lost_requester": "ended, this command was not heard any more",
    "disarmed": "ended, the robot is disarmed",
    "lost_odometry": "ended, odometry is lost",
    "lost_localization": "ended, where it is on the map is not known any more",
    "unheard": "HOW IT ENDED IS NOT KNOWN",
    "lost_robot": "the robot is not heard any more",
}
"""Of how a motion ends that has begun."""


@dataclass(frozen=True)
class MotionView:
    """At one moment."""

    state: MotionState

    @property
    def elapsed(self) -> float:
        """s since it was accepted."""
        return self.state.elapsed

    @property
    def share(self) -> float:
        """Of the way, 0 to 1; of a pattern, of its steps."""
        state = self.state
        if state.stage == "ended":
            return 1.0 if state.outcome == "arrived" else 0.0
        if state.steps > 1:
            return max(0, state.step - 1) / state.steps
        done, asked = state.achieved, state.asked
        whole, part = (asked.path, done.path) if abs(asked.path) > _LEAST else (asked.yaw, done.yaw)
        return min(1.0, max(0.0, part / whole)) if abs(whole) > _LEAST else 0.0

    def render(self) -> RenderableType:
        bar = Table.grid(padding=(0, 1))
        text = Text(printable(self._words()), no_wrap=True, overflow="ellipsis")
        bar.add_row(ProgressBar(total=1.0, completed=self.share, width=_BAR), text)
        return bar

    def line(self) -> str:
        return f"{self.state.elapsed:6.1f} s | {self._words()}"

    def _words(self) -> str:
        state = self.state
        parts: list[str] = [state.stage]
        if state.steps > 1:
            parts.append(f"step {state.step} of {state.steps}")
        parts.append(way_of(state))
        if state.reason:
            parts.append(str(state.reason))
        return " | ".join(parts)


def describe(robot: str, result: MotionResult, place: MapPose | None = None) -> str:
    """Tell in one line how it ended, with the way out. `place`: at the end of a motion to a point of the map."""
    if not result.begun:
        return printable(f"{robot} has not moved: {result.reason or result.outcome}")
    way = result.way
    if place is not None:
        metres, radians = sigma_of(place)
        way += f"; on the map, {place.state}: ± {metres:.2f} m, {math.degrees(radians):.1f}°"
    if result.arrived:
        return f"{robot}: arrived after {result.elapsed:.1f} s: {way}"
    head = _HEADS.get(result.outcome, result.outcome)
    step = f" in step {result.step} of {result.steps}" if result.steps > 1 else ""
    why = f": {result.reason}" if result.reason else ""
    return printable(f"{robot}: {head}{step}{why}; it came {way}")


def document(robot: str, result: MotionResult, place: MapPose | None = None) -> dict[str, Any]:
    """Tell the same to programs: m, rad and s."""
    told = msgspec.structs.asdict(result) | {"standard_deviations": _by_axis(result.standard_deviations)}
    if place is not None:
        told["map"] = {"state": place.state, "standard_deviations": _by_axis(place.standard_deviations)}
    return {"robot": robot, **told}


def _by_axis(deviations: tuple[float, float, float]) -> dict[str, float]:
    return dict(zip(("x", "y", "yaw"), deviations, strict=True))
