"""`giraff odom`: tells odometry where the robot is, and says where it was taken to be before."""

from __future__ import annotations

import math
import secrets
import time
from typing import Final, NamedTuple

from giraff_cli.network.connection import RobotConnection
from giraff_cli.network.user import user_at_host
from giraff_core.latest import LatestSamples
from giraff_node import robot_now_ns
from giraff_node.network.discovery import others
from giraff_node.network.query_client import QueryClient
from giraff_schemas.messages import Odometry
from giraff_schemas.requests import OdomAnswer, OdomReset, OdomSetPose
from giraff_schemas.topics import ODOM, ODOM_RESET, ODOM_SET_POSE, Query, RequestT

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


class Place(NamedTuple):
    """As it was typed."""

    x: float
    """m"""
    y: float
    """m"""
    yaw: float
    position_sd: float
    """m"""
    yaw_sd: float
    degrees: bool
    """The angles are degrees; else rad."""

    def fault(self) -> str:
        """What cannot be meant of it, with the way out; empty: nothing."""
        whole, unit = (360.0, "°") if self.degrees else (math.tau, " rad")
        if abs(self.yaw) > whole and not self.degrees:
            return f"YAW {self.yaw:g}{unit} is more than a whole turn; if it is in degrees: --degrees"
        if self.yaw_sd > whole:
            return f"--yaw-sd {self.yaw_sd:g}{unit} is more than a whole turn; {whole:.3g}{unit} knows nothing of YAW"
        return ""

    def request(self) -> OdomSetPose:
        """A wish of its own each time."""
        rad = math.radians(1.0) if self.degrees else 1.0
        return OdomSetPose(
            by=user_at_host(),
            id=secrets.randbits(63),
            x=self.x,
            y=self.y,
            yaw=self.yaw * rad,
            position_sd=self.position_sd,
            yaw_sd=self.yaw_sd * rad,
        )


def reset(connection: RobotConnection, timeout: float) -> Result:
    """Let odometry begin anew here."""
    return _jump(connection, ODOM_RESET, OdomReset(by=user_at_host(), id=secrets.randbits(63)), timeout)


def set_pose(connection: RobotConnection, place: Place, timeout: float) -> Result:
    """Let odometry take the robot to be there."""
    return _jump(connection, ODOM_SET_POSE, place.request(), timeout)


def _jump(connection: RobotConnection, query: Query[RequestT, OdomAnswer], request: RequestT, timeout: float) -> Result:
    """Ask until odometry answers, and look where it takes the robot to be then."""
    robot, deadline = connection.robot, time.monotonic() + timeout
    connection.subscribe_all((ODOM,))
    before = _next(connection, min(deadline, time.monotonic() + _HEAR_WITHIN))
    asking = QueryClient(connection.session, robot, query, request)
    answer = asking.wait(deadline)
    if answer is None:
        why = asking.fault or f"nobody answered {asking.key}"
        return Result(
            UNANSWERED,
            f"NOT CONFIRMED after {timeout:g} s: {why}; check that giraff_odometry runs; "
            f"on a secured network [network.access] says who may ask{others(connection.session, robot)}",
        )
    if not answer.done:
        return Result(REFUSED, f"odometry of {robot} refuses: {answer.reason}")
    after = _next(connection, time.monotonic() + _HEAR_WITHIN, answer.jumps)
    return Result(DONE, f"{robot}: odometry was {_where(before)}, is {_where(after)}; jump {answer.jumps}")


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
