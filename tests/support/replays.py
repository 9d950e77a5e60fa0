"""What was said on the network while the robot drove, and saying it again, byte for byte, when it is old."""

import time
from typing import NamedTuple

import zenoh

from giraff_schemas.topics import CMD_VEL, OPERATOR_CMD_VEL, RANGE
from tests.support.process_robot import BRIEF, ProcessRobot

RECORDED = (OPERATOR_CMD_VEL, CMD_VEL, RANGE)
"""Everything that a drive is made of."""


class Said(NamedTuple):
    """One sample as it was on the network."""

    at: float
    """Monotonic s."""
    key: str
    payload: bytes
    encoding: str


def record_drive(robot: ProcessRobot, seconds: float) -> list[Said]:
    """Drive forward; every sample of it."""
    said: list[Said] = []

    def hear(sample: zenoh.Sample) -> None:
        said.append(Said(time.monotonic(), str(sample.key_expr), bytes(sample.payload), str(sample.encoding)))

    for topic in RECORDED:
        robot.observer.listen_raw(topic, hear)
    robot.drive_forward(BRIEF)
    robot.run(seconds)
    return list(said)


def say_again(robot: ProcessRobot, said: list[Said], late: float) -> None:
    """Each sample again, verbatim, `late` seconds after it was first said, in its own rhythm."""
    for sample in said:
        time.sleep(max(0.0, sample.at + late - time.monotonic()))
        robot.observer.session.put(
            sample.key,
            sample.payload,
            encoding=sample.encoding,
            congestion_control=zenoh.CongestionControl.DROP,
            priority=zenoh.Priority.REAL_TIME,
            express=True,
        )
