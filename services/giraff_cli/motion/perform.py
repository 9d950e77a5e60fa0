"""Asks for a motion or a route, shows how it goes, and tells how it ended. Ctrl-C ends the motion first."""

import math
import time
from collections.abc import Sequence
from contextlib import closing, suppress
from dataclasses import dataclass
from typing import Any, Final

import msgspec
from rich.console import RenderableType
from rich.progress_bar import ProgressBar
from rich.table import Table
from rich.text import Text

from giraff_core.latest import LatestSamples
from giraff_core.motion.result import NO_WAY, MotionResult, spot_of, way_of
from giraff_core.motion.wish import RouteWish, Wish
from giraff_node import robot_now_ns
from giraff_node.motion_client import TURN, MotionClient
from giraff_node.network.consent import NoRobotError
from giraff_node.network.discovery import not_found_text
from giraff_node.network.tokens import list_robots
from giraff_schemas.localization import MapPose
from giraff_schemas.motion import GoTo, MotionState
from giraff_schemas.places import RouteState
from giraff_schemas.text import printable
from giraff_schemas.topics import POSE
from giraff_telemetry.localization import sigma_of
from giraff_tools.network.command import UNUSABLE, print_error, run_with_robot
from giraff_tools.network.connection import MovedError, RobotConnection
from giraff_tools.terminal.output import discard_stdout
from giraff_tools.terminal.page import print_json
from giraff_tools.terminal.program import user_at_host
from giraff_tools.terminal.screen import NullScreen, Screen, open_screen
from giraff_tools.terminal.signals import StopSignal

ARRIVED: Final = 0
ENDED: Final = 1

_PATIENCE: Final = 3.0  # s, for a robot to be found, and to be heard
_SHOW_EVERY: Final = 0.1  # s
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
    "no_room": "ended, it cannot stand at its goal",
    "no_way": "ended, no way leads to its goal",
    "too_narrow": "ended, each way is too narrow",
    "forbidden": "ended, each way crosses a no-go line",
    "unheard": "HOW IT ENDED IS NOT KNOWN",
    "lost_robot": "the robot is not heard any more",
}
"""Words for how a motion has ended that had begun."""


def perform(robot: str | None, connect: Sequence[str], wish: Wish | RouteWish, *, as_json: bool) -> int:
    """From the wish to its end; the exit code."""
    with StopSignal() as stopping:
        return run_with_robot(
            robot, connect, lambda met: MotionRun(met, wish, stopping).run(as_json=as_json), moves=True
        )


class MotionRun:
    """One motion or route of a robot that is there, and its reader."""

    def __init__(self, connection: RobotConnection, wish: Wish | RouteWish, stopping: StopSignal) -> None:
        self._connection, self._stopping = connection, stopping
        self._client = MotionClient(connection.session, connection.robot, user_at_host(), wish)
        if isinstance(wish, RouteWish) or any(isinstance(step, GoTo) and step.frame == "map" for step in wish.steps):
            connection.subscribe(POSE)
        self._reader_gone = False
        self._show_at = 0.0

    def run(self, *, as_json: bool) -> int:
        """The whole of it; the exit code. Raises NoRobotError."""
        with closing(self._client), closing(NullScreen() if as_json else open_screen(page=False)) as screen:
            result = self._follow(screen)
        robot, place = self._connection.robot, self._place()
        if self._reader_gone:
            discard_stdout()
        elif as_json:
            print_json(document(robot, result, place))
        if result.arrived:
            if not as_json:
                print(describe(robot, result, place), flush=True)
            return ARRIVED
        if not as_json or not result.begun:
            print_error(describe(robot, result, place))
        return ENDED if result.begun else UNUSABLE

    def _follow(self, screen: Screen) -> MotionResult:
        began = time.monotonic()
        while (result := self._client.turn(now := time.monotonic())) is None:
            self._show(screen, now)
            if self._stopping.asked:
                self._client.cancel(now)
            elif not self._client.has_asked and now - began > _PATIENCE:
                raise NoRobotError(self._unheard())
            self._stopping.wait(TURN, patience=self._stopping.asked + 1)
        return result

    def _place(self) -> MapPose | None:
        """Return where localization has the robot at the end. None: the motion was on no map, or nothing was heard."""
        heard = LatestSamples()
        with suppress(MovedError):  # the motion is over: it is not to be asked again
            self._connection.dispatch(heard)
        latest = heard.latest(POSE, robot_now_ns())
        return latest.sample if latest is not None and latest.fresh else None

    def _show(self, screen: Screen, now: float) -> None:
        state = self._client.state
        if state is None or self._reader_gone or now < self._show_at:
            return
        self._show_at = now + _SHOW_EVERY
        try:
            screen.show(MotionView(state))
        except OSError:  # nobody sees any more what the robot does
            self._reader_gone = True
            self._stopping.ask()

    def _unheard(self) -> str:
        robot, there = self._connection.robot, list_robots(self._connection.session)
        if robot in there:
            return f"the clock of {robot} is not heard within {_PATIENCE:g} s; check that giraff_base runs"
        return not_found_text(robot, there)


@dataclass(frozen=True)
class MotionView:
    """A motion at one moment."""

    state: MotionState

    @property
    def elapsed(self) -> float:
        """s since it was accepted."""
        return self.state.elapsed

    @property
    def share(self) -> float:
        """Share of the way, 0 to 1; of a pattern, of its steps."""
        state = self.state
        if state.stage == "ended":
            return 1.0 if state.outcome == "arrived" else 0.0
        if state.steps > 1 and not isinstance(state, RouteState):
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
            parts.append(f"{'leg' if isinstance(state, RouteState) else 'step'} {state.step} of {state.steps}")
        parts.append(way_of(state))
        if state.reason:
            parts.append(str(state.reason))
        return " | ".join(parts)


def describe(robot: str, result: MotionResult, place: MapPose | None = None) -> str:
    """Tell in one line how it ended, with the way out. `place`: at the end of what went by the map."""
    if not result.begun:
        return printable(f"{robot} has not moved: {result.reason or result.outcome}")
    way = f"{result.way} to {result.place}" if result.place and not result.arrived else result.way
    if place is not None:
        metres, radians = sigma_of(place)
        way += f"; on the map, {place.state}: ± {metres:.2f} m, {math.degrees(radians):.1f}°"
    if result.arrived:
        there = f" at {result.place}" if result.place else ""
        return printable(f"{robot}: arrived{there} after {result.elapsed:.1f} s: {way}")
    head = _HEADS.get(result.outcome, result.outcome)
    part = "step" if result.place is None else "leg"
    has_parts = result.steps > 1 and result.outcome not in NO_WAY
    step = f" in {part} {result.step} of {result.steps}" if has_parts else ""
    spot = f", {where}" if (where := spot_of(result)) else ""
    why = f": {result.reason}" if result.reason else ""
    return printable(f"{robot}: {head}{step}{spot}{why}; it came {way}")


def document(robot: str, result: MotionResult, place: MapPose | None = None) -> dict[str, Any]:
    """Tell the same to programs: m, rad and s."""
    told = msgspec.structs.asdict(result) | {"standard_deviations": _by_axis(result.standard_deviations)}
    if place is not None:
        told["map"] = {"state": place.state, "standard_deviations": _by_axis(place.standard_deviations)}
    return {"robot": robot, **told}


def _by_axis(deviations: tuple[float, float, float]) -> dict[str, float]:
    return dict(zip(("x", "y", "yaw"), deviations, strict=True))
