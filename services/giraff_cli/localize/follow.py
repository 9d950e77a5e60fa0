"""`giraff localize` with no map of its own: the localization that runs on the network, shown or asked."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from contextlib import closing
from typing import Final

from giraff_cli.localize.client import DONE, ask, require_there
from giraff_cli.localize.hearing import Hearing
from giraff_cli.localize.lines import screen_of
from giraff_core.kinematics.pose import Pose
from giraff_schemas.text import printable
from giraff_tools.network.command import print_error, run_with_robot
from giraff_tools.network.connection import RobotConnection
from giraff_tools.terminal.page import print_json
from giraff_tools.terminal.signals import StopSignal

_PATIENCE: Final = 3.0  # s, for a robot to be found, and for an answer
_TURN: Final = 0.1  # s


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
        return run_with_robot(robot, connect, _PATIENCE, act)


def give_place(robot: str | None, connect: Sequence[str], place: Pose | None, *, as_json: bool) -> int:
    """Tell it where the robot is; None: have it look anywhere; the exit code."""

    def act(connection: RobotConnection) -> int:
        code, text = ask(connection, place, _PATIENCE)
        if as_json:
            print_json({"robot": connection.robot, "done": code == DONE, "text": text})
        elif code == DONE:
            print(printable(text), flush=True)
        if code != DONE:
            print_error(text)
        return code

    return run_with_robot(robot, connect, _PATIENCE, act, moves=True)
