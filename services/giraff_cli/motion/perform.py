"""Asks for a motion, shows how it goes, and tells how it ended. Ctrl-C ends the motion first."""

from __future__ import annotations

import time
from collections.abc import Sequence
from contextlib import closing, suppress
from typing import Final

from giraff_cli.motion.view import MotionView, describe, document
from giraff_core.latest import LatestSamples
from giraff_core.motion.result import MotionResult
from giraff_node import robot_now_ns
from giraff_node.motion_client import TURN, MotionClient, Wish
from giraff_node.network.consent import NoRobotError
from giraff_node.network.discovery import not_found_text
from giraff_node.network.tokens import list_robots
from giraff_schemas.localization import MapPose
from giraff_schemas.motion import GoTo
from giraff_schemas.topics import POSE
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


def perform(robot: str | None, connect: Sequence[str], wish: Wish, *, as_json: bool) -> int:
    """From the wish to its end; the exit code."""
    with StopSignal() as stopping:
        return run_with_robot(
            robot,
            connect,
            _PATIENCE,
            lambda connection: MotionRun(connection, wish, stopping).run(as_json=as_json),
            moves=True,
        )


class MotionRun:
    """One motion of a robot that is there, and its reader."""

    def __init__(self, connection: RobotConnection, wish: Wish, stopping: StopSignal) -> None:
        self._connection, self._stopping = connection, stopping
        self._client = MotionClient(connection.session, connection.robot, user_at_host(), wish)
        if any(isinstance(step, GoTo) and step.frame == "map" for step in wish.steps):
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
