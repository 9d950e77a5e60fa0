"""Shows what localization says: a floor plan or a line for people, an object for programs."""

import math
import re
import time
from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass
from typing import Any, Final, Protocol

import msgspec
from rich.console import RenderableType

from giraff_cli.localize.client import DONE, require_there
from giraff_core.latest import Latest
from giraff_maps.floor_plan import FloorPlan
from giraff_node import robot_now_ns
from giraff_schemas.localization import MapPose
from giraff_schemas.messages import Sample
from giraff_schemas.text import printable
from giraff_schemas.topics import POSE, Topic
from giraff_telemetry.localization import pose_text
from giraff_tools.network.command import run_with_robot
from giraff_tools.network.connection import RobotConnection
from giraff_tools.terminal.floor import plan_and_words
from giraff_tools.terminal.screen import Terminal, open_screen
from giraff_tools.terminal.signals import StopSignal
from giraff_tools.terminal.text import json_line

_FIGURES: Final = re.compile(r"\d+")
_STYLE: Final = {"localized": "green", "told": "yellow", "ambiguous": "yellow", "lost": "red", "no_map": "red"}
_QUIET: Final = 1.0  # s between two lines that only say that it has moved
_SHOW_EVERY: Final = 0.1  # s, while nothing is said
_TURN: Final = 0.1  # s


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
        return plan_and_words(self.plan, pose, self.words, style)

    def line(self) -> str:
        return f"{self.elapsed:6.1f} s | {self.words}"


def document(robot: str, pose: MapPose) -> dict[str, Any]:
    """A pose for programs: m and rad."""
    x_sd, y_sd, yaw_sd = pose.standard_deviations
    deviations = {"x": x_sd, "y": y_sd, "yaw": yaw_sd}
    return {"robot": robot, **msgspec.to_builtins(pose), "standard_deviations": deviations}


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


class Hearing:
    """Of one robot's, from now on."""

    def __init__(self, connection: RobotConnection, screen: PoseScreen, plan: FloorPlan | None = None) -> None:
        """`plan`: to be shown, where the screen is a terminal."""
        self._connection = connection
        self._screen, self._plan = screen, plan
        self._began = time.monotonic()
        self._heard_ns = 0
        self._has_news = False
        self._shown = -math.inf
        self.pose: MapPose | None = None
        """The newest."""
        connection.subscribe(POSE)

    def update(self) -> None:
        """Show what was said since the last call; else how old it is. Raises OSError where nobody sees it any more."""
        self._has_news = False
        self._connection.dispatch(self)
        if not self._has_news and time.monotonic() - self._shown >= _SHOW_EVERY:
            self._show()

    def on_sample(self, topic: Topic[Any], key: str, sample: Sample, at_ns: int) -> None:
        """Of the connection."""
        del topic, key
        if isinstance(sample, MapPose):
            self.pose, self._heard_ns, self._has_news = sample, at_ns, True
            self._show()

    def on_liveliness(self, service: str, instance: str, *, present: bool) -> None:
        """What it says counts here, not that it is there."""

    def _show(self) -> None:
        self._shown = time.monotonic()
        latest = None if self.pose is None else Latest(self.pose, (robot_now_ns() - self._heard_ns) * 1e-9)
        self._screen.show(PoseView(self._connection.robot, time.monotonic() - self._began, latest, self._plan))


def follow(robot: str | None, connect: Sequence[str], seconds: float | None, *, as_json: bool) -> int:
    """Show what it says until Ctrl-C, or for `seconds`; the exit code."""

    def act(connection: RobotConnection) -> int:
        require_there(connection)
        until = time.monotonic() + (math.inf if seconds is None else seconds)
        with closing(screen_of(as_json=as_json)) as screen:
            hearing = Hearing(connection, screen)
            while time.monotonic() < until and not stopping.wait(_TURN):
                hearing.update()
        return DONE

    with StopSignal() as stopping:
        return run_with_robot(robot, connect, act)
