"""The guard's senses, by the types of sensors that a robot file may have."""

from typing import Any

from giraff_core.live import Live
from giraff_core.robot import RobotConfig
from giraff_core.sensors import SENSED, TYPES
from giraff_guard.bumper import BumperSource
from giraff_guard.config import GuardConfig
from giraff_guard.source import Source
from giraff_guard.ultrasonic.source import UltrasonicSource
from giraff_schemas.bumper import Bump
from giraff_schemas.messages import Range
from giraff_schemas.topics import Topic

Sensed = Range | Bump
"""A sample of a topic in `SENSED`."""


def sensed_by(robot: RobotConfig) -> list[Topic[Any]]:
    """Return the topics of the sensors that the robot has."""
    return [topic for table, topic in SENSED.items() if getattr(robot, table)]


def sources_of(live: Live[GuardConfig], robot: RobotConfig) -> list[Source]:
    """All of one robot, the one that is named first where two allow the same. Raises ValueError."""
    for name, kind in robot.unknown_sensors.items():
        known = ", ".join(TYPES)
        raise ValueError(
            f"[robot.sensors.{name}] is of the type {kind!r}, which the guard does not know; known are: {known}"
        )
    return [UltrasonicSource(live, robot), *([BumperSource(live, robot)] if robot.bumpers else [])]
