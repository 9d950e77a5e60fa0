"""`giraff odom`: tells odometry where the robot is, and says where it was taken to be before."""

import math
import secrets
import time
from typing import Final, NamedTuple

from giraff_core.kinematics.pose import Pose
from giraff_core.latest import LatestSamples
from giraff_node import robot_now_ns
from giraff_node.network.discovery import others
from giraff_node.network.query_client import QueryClient
from giraff_schemas.messages import Odometry
from giraff_schemas.requests import OdomAnswer, OdomReset, OdomSetPose
from giraff_schemas.topics import ODOM, ODOM_RESET, ODOM_SET_POSE, Query, RequestT
from giraff_tools.network.connection import RobotConnection
from giraff_tools.terminal.program import user_at_host

DONE: Final = 0
REFUSED: Final = 1
UNANSWERED: Final = 2

_HEAR_WITHIN: Final = 1.0  # s; odometry speaks a hundred times a second
_TURN: Final = 0.01  # s
_UNHEARD: Final = "not heard: it speaks once base tells it of the wheels"


class Result(NamedTuple):
    """How it ended."""

    code: int
    text: str
    robot: str
    done: bool | None = None
    """Unknown where it is None, as each of these fields."""
    reason: str | None = None
    """Why it is not done."""
    jumps: int | None = None
    x: float | None = None
    """m, after it."""
    y: float | None = None
    """m."""
    yaw: float | None = None
    """rad."""


def reset(connection: RobotConnection, timeout: float) -> Result:
    """Let odometry begin anew here."""
    return _jump(connection, ODOM_RESET, OdomReset(by=user_at_host(), id=secrets.randbits(63)), timeout)


def set_pose(connection: RobotConnection, pose: Pose, position_sd: float, yaw_sd: float, timeout: float) -> Result:
    """Let odometry take the robot to be there. The deviations are m and rad."""
    x, y, yaw = pose
    request = OdomSetPose(
        by=user_at_host(), id=secrets.randbits(63), x=x, y=y, yaw=yaw, position_sd=position_sd, yaw_sd=yaw_sd
    )
    return _jump(connection, ODOM_SET_POSE, request, timeout)


def _jump(connection: RobotConnection, query: Query[RequestT, OdomAnswer], request: RequestT, timeout: float) -> Result:
    """Ask until odometry answers, and look where it takes the robot to be then."""
    robot, deadline = connection.robot, time.monotonic() + timeout
    connection.subscribe_all((ODOM,))
    before = _next(connection, min(deadline, time.monotonic() + _HEAR_WITHIN))
    asking = QueryClient(connection.session, robot, query, request)
    answer = asking.wait(deadline)
    if answer is None:
        told = asking.not_confirmed(timeout, "check that giraff_odometry runs") + others(connection.session, robot)
        return Result(UNANSWERED, told, robot, reason=asking.silence)
    if not answer.done:
        told = f"odometry of {robot} refuses: {answer.reason}"
        return Result(REFUSED, told, robot, done=False, reason=str(answer.reason), jumps=answer.jumps)
    after = _next(connection, time.monotonic() + _HEAR_WITHIN, answer.jumps)
    told = f"{robot}: odometry was {_where(before)}, is {_where(after)}; jump {answer.jumps}"
    result = Result(DONE, told, robot, done=True, jumps=answer.jumps)
    return result if after is None else result._replace(x=after.x, y=after.y, yaw=after.yaw)


def _next(connection: RobotConnection, until: float, jumps: int = 0) -> Odometry | None:
    """The newest sample after so many jumps; None: there is none by `until`."""
    heard = LatestSamples()
    while time.monotonic() < until:
        connection.dispatch(heard)
        newest = heard.latest(ODOM, robot_now_ns())
        if newest is not None and newest.sample.jumps >= jumps:
            return newest.sample
        time.sleep(_TURN)
    return None


def _where(odometry: Odometry | None) -> str:
    if odometry is None:
        return _UNHEARD
    yaw = f"yaw {odometry.yaw:z.3f} rad ({math.degrees(odometry.yaw):z.1f}°)"
    return f"at x {odometry.x:z.3f} m, y {odometry.y:z.3f} m, {yaw}"
