"""Asks the localization that runs on the network: who is it, look here, look anywhere."""

import math
import secrets
import time
from collections.abc import Sequence
from typing import Final, NamedTuple

from giraff_core.kinematics.pose import Pose
from giraff_node.network.consent import NoRobotError
from giraff_node.network.discovery import not_found_text
from giraff_node.network.query_client import QueryClient
from giraff_node.network.tokens import list_robots
from giraff_schemas.localization import LocalizationAnswer, LocalizationGlobal, LocalizationSetPose
from giraff_schemas.text import printable
from giraff_schemas.topics import LOCALIZATION_GLOBAL, LOCALIZATION_SET_POSE, Query, RequestT
from giraff_telemetry.localization import place_text
from giraff_tools.network.command import print_error, run_with_robot
from giraff_tools.network.connection import RobotConnection
from giraff_tools.network.localization import is_there
from giraff_tools.terminal.page import print_json
from giraff_tools.terminal.program import user_at_host

DONE: Final = 0
REFUSED: Final = 1
UNANSWERED: Final = 2

_PATIENCE: Final = 3.0  # s, for an answer
_LOOKS: Final = 4  # times: a session that has just begun is not linked with every process yet
_BETWEEN: Final = 0.25  # s
_HOW_TO_START: Final = "`giraff localize --map FILE` starts one in this terminal, `giraff run --localize` beside a run"


class Result(NamedTuple):
    """How it ended."""

    code: int
    text: str


def told_pose(pose: Pose) -> LocalizationSetPose:
    """Return a new request to take the robot to be there."""
    x, y, yaw = pose
    return LocalizationSetPose(by=user_at_host(), id=secrets.randbits(63), x=x, y=y, yaw=yaw)


def require_there(connection: RobotConnection) -> None:
    """Raises NoRobotError, with the way out, where none runs."""
    for _ in range(_LOOKS):
        if is_there(connection):
            break
        time.sleep(_BETWEEN)
    else:
        there = list_robots(connection.session)
        if connection.robot not in there:
            raise NoRobotError(not_found_text(connection.robot, there))
        raise NoRobotError(f"no localization of {connection.robot} runs on the network; {_HOW_TO_START}")


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

    return run_with_robot(robot, connect, act, moves=True)


def ask(connection: RobotConnection, place: Pose | None, timeout: float) -> Result:
    """Tell it where the robot is; None: have it look anywhere. Raises NoRobotError where there is none to ask."""
    require_there(connection)
    if place is None:
        anywhere = LocalizationGlobal(by=user_at_host(), id=secrets.randbits(63))
        return _asked(connection, LOCALIZATION_GLOBAL, anywhere, timeout, "is looked for anywhere on the map")
    request = told_pose(place)
    sd = math.sqrt(2.0) * request.position_sd
    told = (
        f"is taken to be at about {place_text(*place)}, ± {sd:.2f} m, {math.degrees(request.yaw_sd):.0f}°; "
        "`giraff go X,Y --frame map` goes by it until something contradicts it"
    )
    return _asked(connection, LOCALIZATION_SET_POSE, request, timeout, told)


def _asked(
    connection: RobotConnection,
    query: Query[RequestT, LocalizationAnswer],
    request: RequestT,
    timeout: float,
    done: str,
) -> Result:
    asking = QueryClient(connection.session, connection.robot, query, request)
    answer = asking.wait(time.monotonic() + timeout)
    if answer is None:
        return Result(UNANSWERED, asking.not_confirmed(timeout, "check that giraff_localization runs"))
    if not answer.done:
        return Result(REFUSED, f"localization of {connection.robot} refuses: {answer.reason}")
    return Result(DONE, f"{connection.robot} {done}")
