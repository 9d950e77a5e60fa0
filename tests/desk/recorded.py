"""A recorded drive of the simulated robot: a way with a bend, and at its end a wall that blocks it."""

from __future__ import annotations

import math
import time
from pathlib import Path

import msgspec
import zenoh

from giraff_mcap.heard import Heard
from giraff_mcap.writing import RecordingWriter
from giraff_node.config import read_tables
from giraff_schemas.topics import TOPICS
from tests.system.robot import FULL_TILT, ProcessRobot


def drive_into_view(robot: ProcessRobot) -> None:
    """Forward, a bend to the left, and up to a wall."""
    robot.drive_forward()
    robot.hold(FULL_TILT, 3.0)
    robot.run(2.0)
    robot.hold(FULL_TILT, 0.0)
    robot.run(0.5)
    at = robot.simulator.state()
    reach = 1.2
    x, y = at.x + reach * math.cos(at.yaw), at.y + reach * math.sin(at.yaw)
    across = (-1.5 * math.sin(at.yaw), 1.5 * math.cos(at.yaw))
    robot.simulator.add_wall("end", [(x - across[0], y - across[1]), (x + across[0], y + across[1])])
    robot.run(3.0)


def record_drive(robot: ProcessRobot, path: Path) -> None:
    """Record it, with all that is said meanwhile."""
    heard: list[Heard] = []

    def hear(sample: zenoh.Sample) -> None:
        key, encoding = str(sample.key_expr), str(sample.encoding)
        heard.append(Heard(time.monotonic_ns(), key, bytes(sample.payload), encoding, 4, express=False))

    tables = msgspec.json.encode(read_tables(robot.environment)).decode()
    with RecordingWriter(path, {"robot": "sim-test", "tables": tables}) as writer:
        for topic in TOPICS:
            robot.observer.listen_raw(topic, hear)
        drive_into_view(robot)
        writer.add(list(heard))
        writer.close("test")
