"""A short visit to the network: find the robot, ask, tell, leave."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Sequence
from typing import Final

import zenoh

from giraff_cli.network.connection import Watcher
from giraff_cli.terminal.output import written
from giraff_node.config.robot_file import ConfigError
from giraff_node.network.discovery import CORRECT_IT, NoRobotError, find_way, only_robot
from giraff_node.network.session import open_session
from giraff_node.process.lifecycle import start_anew

UNUSABLE: Final = 2

_CLOSE_WITHIN: Final = 0.3  # s; whoever has ended a command does not wait, and the robot sees a dead link at once


class MovedError(Exception):
    """This host is to be found at other addresses than when the visit began."""


def visit(
    robot: str | None,
    connect: Sequence[str],
    patience: float,
    act: Callable[[Watcher], int],
    lost: Callable[[], str] | None = None,
) -> int:
    """The exit code of `act`, or UNUSABLE where there is no robot to act on. `patience`: s, to look for one.

    `lost`: the way out where robot file or environment cannot tell which robot it is, or on which network.
    """

    def find_and_act(watcher: Watcher) -> int:
        watcher.robot = watcher.robot or only_robot(watcher.session, patience)
        return act(watcher)

    return join(robot, connect, find_and_act, lost)


def join(
    robot: str | None,
    connect: Sequence[str],
    act: Callable[[Watcher], int],
    lost: Callable[[], str] | None = None,
) -> int:
    """The exit code of `act` on the network, whose watcher has no robot where nobody has named one; or UNUSABLE."""
    try:
        way = find_way(robot, connect)
    except NoRobotError as error:
        return complain(str(error))
    except ConfigError as error:
        return complain(f"{error}; {lost() if lost else CORRECT_IT}")
    if way.warning:
        complain(f"not everything of robot file and environment counts: {way.warning}")
    try:
        session = open_session(way.network, way.robot or "*", visiting=True)
    except ConfigError as error:
        return complain(str(error))
    except zenoh.ZError as error:
        return complain(f"no Zenoh session: {error}; check the table [network] of the robot file, and --connect")
    watcher = Watcher(way.robot, session)
    try:
        code = written(lambda: act(watcher))
    except MovedError:
        watcher.close(_CLOSE_WITHIN)
        start_anew()
    except NoRobotError as error:
        code = complain(str(error))
    if not watcher.close(_CLOSE_WITHIN):  # Zenoh would hold the process, and nothing is left to do
        os._exit(code)
    return code


def complain(text: str) -> int:
    """Tell what is wrong; UNUSABLE."""
    print(f"giraff: {text}", file=sys.stderr, flush=True)
    return UNUSABLE
