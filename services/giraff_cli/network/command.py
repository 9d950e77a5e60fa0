"""Run a command on the network: find the robot, open Zenoh, act, close."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Sequence
from typing import Final

import zenoh

from giraff_cli.network.connection import RobotConnection
from giraff_cli.terminal.output import guard_stdout
from giraff_node.config.robot_file import ConfigError
from giraff_node.network.discovery import CORRECT_IT, NoRobotError, find_only_robot, resolve_target
from giraff_node.network.session import open_session
from giraff_node.process.lifecycle import restart_program

UNUSABLE: Final = 2

_CLOSE_WITHIN: Final = 0.3  # s; whoever has ended a command does not wait, and the robot sees a dead link at once


class MovedError(Exception):
    """This host is to be found at other addresses than when the visit began."""


def run_with_robot(
    robot: str | None,
    connect: Sequence[str],
    patience: float,
    act: Callable[[RobotConnection], int],
    lost: Callable[[], str] | None = None,
) -> int:
    """The exit code of `act`, or UNUSABLE where there is no robot to act on. `patience`: s, to look for one.

    `lost`: the way out where robot file or environment cannot tell which robot it is, or on which network.
    """

    def find_and_act(connection: RobotConnection) -> int:
        connection.robot = connection.robot or find_only_robot(connection.session, patience)
        return act(connection)

    return run_on_network(robot, connect, find_and_act, lost)


def run_on_network(
    robot: str | None,
    connect: Sequence[str],
    act: Callable[[RobotConnection], int],
    lost: Callable[[], str] | None = None,
) -> int:
    """The exit code of `act` on the network, whose connection has no robot where nobody has named one; or UNUSABLE."""
    try:
        way = resolve_target(robot, connect)
    except NoRobotError as error:
        return print_error(str(error))
    except ConfigError as error:
        return print_error(f"{error}; {lost() if lost else CORRECT_IT}")
    if way.warning:
        print_error(f"not everything of robot file and environment counts: {way.warning}")
    try:
        session = open_session(way.network, way.robot or "*", visiting=True)
    except ConfigError as error:
        return print_error(str(error))
    except zenoh.ZError as error:
        return print_error(f"no Zenoh session: {error}; check the table [network] of the robot file, and --connect")
    connection = RobotConnection(way.robot, session)
    try:
        code = guard_stdout(lambda: act(connection))
    except MovedError:
        connection.close(_CLOSE_WITHIN)
        restart_program()
    except NoRobotError as error:
        code = print_error(str(error))
    if not connection.close(_CLOSE_WITHIN):  # Zenoh would hold the process, and nothing is left to do
        os._exit(code)
    return code


def print_error(text: str) -> int:
    """Tell what is wrong; UNUSABLE."""
    print(f"giraff: {text}", file=sys.stderr, flush=True)
    return UNUSABLE
