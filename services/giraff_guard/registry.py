"""The guard's senses, by the types of sensors that a robot file may have."""

from typing import Any, Final

from giraff_core.live import Live
from giraff_core.robot import RobotConfig
from giraff_core.senses import SENSED, TYPES, UnknownSensor
from giraff_guard.config import GuardConfig
from giraff_guard.senses.bumper import BumperSource
from giraff_guard.senses.laser_scanner import LaserScannerSource
from giraff_guard.senses.ultrasonic.source import UltrasonicSource
from giraff_guard.source import Source
from giraff_schemas.topics import Topic

SOURCES: Final[tuple[type[Source], ...]] = (UltrasonicSource, LaserScannerSource, BumperSource)
"""Of two senses that allow the same, the first one is named."""


def sensed_by(robot: RobotConfig) -> list[Topic[Any]]:
    """Return the topics of the sensors that the robot has."""
    return [*dict.fromkeys(topic for sense, topic in SENSED.items() if robot.of(sense))]


def sources_of(live: Live[GuardConfig], robot: RobotConfig) -> list[Source]:
    """Return those of one robot. Raises ValueError for a sensor of a type that nobody knows here."""
    for name, unknown in robot.of(UnknownSensor).items():
        raise ValueError(
            f"[robot.sensors.{name}] is of the type {unknown.named!r}, which the guard does not know; "
            f"known are: {', '.join(TYPES)}"
        )
    return [source(live, robot) for source in SOURCES if robot.of(source.sense)]
