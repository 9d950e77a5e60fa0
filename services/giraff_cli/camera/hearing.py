"""Hears of a robot's cameras."""

import time
from typing import Final

from giraff_core.latest import LatestSamples
from giraff_node import robot_now_ns
from giraff_node.network.consent import NoRobotError
from giraff_node.network.discovery import not_found_text
from giraff_node.network.tokens import list_robots
from giraff_schemas.camera import CameraState
from giraff_schemas.topics import CAMERA_STATE
from giraff_tools.network.connection import RobotConnection
from giraff_tools.terminal.signals import StopSignal

_FIRST_WITHIN: Final = 3.0  # s
_LOOK_EVERY: Final = 0.05  # s


def hear_cameras(connection: RobotConnection, stopping: StopSignal, seconds: float) -> dict[str, CameraState]:
    """Return by name the newest state of each camera that is heard within `seconds` of the first. It asks for nothing.

    Raises NoRobotError where there is no robot, or no camera of it is heard.
    """
    heard = LatestSamples()
    connection.subscribe(CAMERA_STATE)
    until = time.monotonic() + _FIRST_WITHIN
    found: dict[str, CameraState] = {}
    while time.monotonic() < until and not stopping.wait(_LOOK_EVERY):
        connection.dispatch(heard)
        latest = heard.all(CAMERA_STATE, robot_now_ns())
        if latest and not found:
            until = time.monotonic() + seconds
        found = {each.sample.camera: each.sample for each in reversed(latest)}
    if not found:
        raise NoRobotError(_silence(connection))
    return dict(sorted(found.items()))


def _silence(connection: RobotConnection) -> str:
    there = list_robots(connection.session)
    if connection.robot not in there:
        return not_found_text(connection.robot, there)
    remedy = "check that giraff_camera runs, and the tables [camera] and [robot.sensors] of the robot file"
    return f"no camera of {connection.robot} is heard; {remedy}"
