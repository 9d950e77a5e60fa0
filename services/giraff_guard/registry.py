"""The guard's senses, by the types of sensors that a robot file may have."""

from typing import Any

from giraff_core.live import Live
from giraff_core.robot import RobotConfig
from giraff_core.senses import SENSED, TYPES, Bumper, UnknownSensor
from giraff_guard.bumper import BumperSource
from giraff_guard.config import GuardConfig
from giraff_guard.source import Source
from giraff_guard.ultrasonic.source import UltrasonicSource
from giraff_schemas.topics import Topic


def sensed_by(robot: RobotConfig) -> list[Topic[Any]]:
    """Return the topics of the sensors that the robot has."""
    return [*dict.fromkeys(topic for sense, topic in SENSED.items() if robot.of(sense))]


def sources_of(live: Live[GuardConfig], robot: RobotConfig) -> list[Source]:
    """All of one robot, the one that is named first where two allow the same. Raises ValueError."""
    for name, unknown in robot.of(UnknownSensor).items():
        raise ValueError(
            f"[robot.sensors.{name}] is of the type {unknown.named!r}, which the guard does not know; "
            f"known are: {', '.join(TYPES)}"
        )
    return [UltrasonicSource(live, robot), *([BumperSource(live, robot)] if robot.of(Bumper) else [])]
