"""Run a command on the network: find the robot, open Zenoh, act, close."""

import os
import shlex
import sys
import time
from collections.abc import Callable, Sequence
from typing import Final

import zenoh

from giraff_node.config.robot_file import ConfigError
from giraff_node.network import consent
from giraff_node.network.consent import NoRobotError
from giraff_node.network.discovery import CORRECT_IT, Target, find_robot, require_consent, resolve_target, stand_in
from giraff_node.network.reach import find_silent, silence_text
from giraff_node.network.session import NobodyError, Role, open_session
from giraff_tools.network.connection import MovedError, RobotConnection
from giraff_tools.terminal.output import guard_stdout
from giraff_tools.terminal.program import called_here

UNUSABLE: Final = 2

_CAME_BACK: Final = "VISITED_BEFORE"
"""Set in the environment of a visit that begins anew at another network: there an address may yet be out of reach."""
_ASK_AGAIN: Final = 0.1  # s
_CLOSE_WITHIN: Final = 0.3  # s; whoever has ended a command does not wait, and the robot sees a dead link at once


class UnopenedError(Exception):
    """No session can be opened on a network. The message says why, and the remedy."""


def run_with_robot(
    robot: str | None,
    connect: Sequence[str],
    act: Callable[[RobotConnection], int],
    *,
    patience: float = 3.0,
    moves: bool = False,
    stands_in: bool = True,
) -> int:
    """The exit code of `act`, or UNUSABLE where there is no robot to act on. `patience`: s, to look for one.

    `moves`: it moves, releases or sets something. One that nobody has named then takes a person's yes. `stands_in`: as
    of `run_on_network`.
    """

    def find_and_act(connection: RobotConnection) -> int:
        if not connection.robot:
            at_door = connection.waited is None
            connection.robot = find_robot(connection.session, connection.filed, patience, at_door=at_door)
            if moves:
                require_consent(connection.session, connection.robot, naming(connection.robot))
        return act(connection)

    return run_on_network(robot, connect, find_and_act, patience=patience, stands_in=stands_in)


def naming(robot: str) -> str:
    """The command that was typed, with the robot named in it."""
    words = sys.argv[1:]
    end = words.index("--") if "--" in words else len(words)  # what comes after it is no option
    return shlex.join([*called_here(), *words[:end], "--robot", robot, *words[end:]])


def run_on_network(
    robot: str | None,
    connect: Sequence[str],
    act: Callable[[RobotConnection], int],
    *,
    records: bool = False,
    role: Role = "client",
    patience: float = 0.0,
    stands_in: bool = False,
) -> int:
    """The exit code of `act` on the network, whose connection has no robot where nobody has named one; or UNUSABLE.

    An address of `connect` that does not answer is an error: another robot would be found in its place.
    `records`: it hears what is no sample of ours (`session_config`). `role`: as there; `patience`: as of `visit`.
    `stands_in`: this host's simulation does for a robot that only a file names and that is not heard (`stand_in`).
    """
    try:
        way = resolve_target(robot, connect)
    except NoRobotError as error:
        return print_error(str(error))
    except ConfigError as error:
        return print_error(f"{error}; {CORRECT_IT}")
    if not os.environ.get(_CAME_BACK) and (silent := find_silent(connect)):
        return print_error(f"--connect {silence_text(silent)}; check the address, and that the robot is on")
    if way.warning:
        print_error(not_all_counts(way.warning))

    def meet_and_act(connection: RobotConnection) -> int:
        connection.robot = stand_in(connection.session, way)
        connection.stands_in_for = way.robot if connection.robot != way.robot else ""
        return act(connection)

    try:
        return visit(way, meet_and_act if stands_in else act, records=records, role=role, patience=patience)
    except UnopenedError as error:
        return print_error(str(error))


def visit(
    way: Target,
    act: Callable[[RobotConnection], int],
    *,
    records: bool = False,
    role: Role = "client",
    patience: float = 0.0,
) -> int:
    """The exit code of `act` on this network. Raises UnopenedError.

    Nobody may be there. Then it is tried again for `patience` s, and after that the connection waits to be met.
    """
    connection = _connected(way, role, records, patience)
    try:
        return guard_stdout(lambda: act(connection))
    except MovedError:
        connection.close(_CLOSE_WITHIN)
        from giraff_node.process.lifecycle import restart_program  # noqa: PLC0415  a service's, which no stop waits for

        restart_program({_CAME_BACK: "yes"})
    except NoRobotError as error:
        return print_error(str(error))
    finally:
        connection.close(_CLOSE_WITHIN)


def _connected(way: Target, role: Role, records: bool, patience: float) -> RobotConnection:
    waited: float | None = None
    began = time.monotonic()
    while True:
        try:
            session = open_session(way.network, way.robot or "*", role, records=records)
        except NobodyError:
            waited = time.monotonic() - began
            if waited >= patience:
                role = "outside"
            time.sleep(_ASK_AGAIN)
        except ConfigError as error:
            raise UnopenedError(str(error)) from error
        except zenoh.ZError as error:
            raise UnopenedError(
                f"no Zenoh session: {error}; check the table [network] of the robot file, and --connect"
            ) from error
        else:
            waited = waited if role == "outside" else None
            return RobotConnection(way.robot, session, way.filed, way.network, waited)


def not_all_counts(warning: str) -> str:
    """Return the warning about entries that no table takes."""
    return f"not everything of robot file and environment counts: {warning}"


def print_error(text: str) -> int:
    """Tell what is wrong; UNUSABLE."""
    consent.print_notice(text)
    return UNUSABLE
