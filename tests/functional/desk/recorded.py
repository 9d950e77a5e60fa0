"""A recorded drive of the simulated robot: a way with a bend, and at its end a wall that blocks it."""

from __future__ import annotations

import time
from pathlib import Path

import msgspec
import zenoh

from giraff_mcap.heard import Heard
from giraff_mcap.writing import RecordingWriter
from giraff_node.config import read_tables
from giraff_schemas.topics import BASE, GUARD, TOPICS
from tests.support.process_robot import FULL_TILT, ProcessRobot


def drive_into_view(robot: ProcessRobot) -> None:
    """Forward, a bend to the left, and up to a wall."""
    robot.drive_forward()
    robot.hold(FULL_TILT, 3.0)
    robot.run(2.0)
    robot.hold(FULL_TILT, 0.0)
    robot.run(0.5)
    robot.put_up_wall("end", ahead=1.2, half_width=1.5)
    robot.wait("the wall", lambda: is_at_wall(robot), 60.0)
    robot.run(1.0)  # it stands, and its path, which is drawn twice a second, ends where it does


def is_at_wall(robot: ProcessRobot) -> bool:
    """Blocked by what a sensor sees, with none in doubt but the rear one, which has heard nothing for long; a busy
    machine's robot that was disarmed drives on."""
    guard, base = robot.observer.newest(GUARD), robot.observer.newest(BASE)
    assert guard is not None
    assert base is not None
    if guard.forward.freedom == "blocked" and "sees something" in guard.forward.reason:
        return {sensor for sensor, reason in guard.sensors.items() if reason} == {"rear"}
    if not base.armed:
        robot.arm(30.0)
        robot.hold(FULL_TILT, 0.0)
    return False


def record_drive(robot: ProcessRobot, path: Path) -> None:
    """Record it, with all that is said meanwhile."""
    heard: list[Heard] = []

    def hear(sample: zenoh.Sample) -> None:
        key, encoding = str(sample.key_expr), str(sample.encoding)
        heard.append(Heard(time.monotonic_ns(), key, bytes(sample.payload), encoding))

    tables = msgspec.json.encode(read_tables(robot.environment)).decode()
    with RecordingWriter(path, {"robot": "sim-test", "tables": tables}) as writer:
        for topic in TOPICS:
            robot.observer.listen_raw(topic, hear)
        drive_into_view(robot)
        writer.add(list(heard))
        writer.close("test")
