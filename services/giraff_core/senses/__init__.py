"""The robot's sensors: `[robot.sensors.<name>]` of the robot file, a union told apart by `type`.

All lists of senses are taken from here.
"""

from collections.abc import Mapping
from typing import Any, Final, get_args

from giraff_core.senses.bumper import Bumper
from giraff_core.senses.camera import Camera
from giraff_core.senses.laser_scanner import LaserScanner
from giraff_core.senses.sense import Evidence, Sense, Sensed, Summary, UnknownSensor
from giraff_core.senses.ultrasonic import HC_SR04, Ultrasonic
from giraff_schemas.services import SERVICES
from giraff_schemas.topics import Topic

__all__ = [
    "HC_SR04",
    "Bumper",
    "Camera",
    "Evidence",
    "LaserScanner",
    "Sense",
    "Sensed",
    "Summary",
    "Ultrasonic",
    "UnknownSensor",
]

KnownSense = Ultrasonic | Bumper | Camera | LaserScanner
"""Each type that a robot file may name. Guard and replay read their topics, and number their samples, in this order."""
AnySense = KnownSense | UnknownSensor
SENSES: Final[tuple[type[Sense], ...]] = get_args(KnownSense)
TYPES: Final = tuple(sorted(sense.type_name() for sense in SENSES))
SENSED: Final[dict[type[Sense], Topic[Any]]] = {sense: sense.TOPIC for sense in SENSES if sense.TOPIC is not None}
"""Topic of each type that the guard listens to."""
SENSE_OF: Final = {topic.schema: sense for sense, topic in SENSED.items()}
"""By type of sample, the type of sensor that says it."""
PUBLISHERS: Final = {
    sense.type_name(): row.name for sense in SENSED for row in SERVICES if sense.TOPIC in row.publishes
}
"""By type, the service that publishes what the guard listens to."""


def typed(robot: Mapping[str, Any]) -> dict[str, Any]:
    """Return the table `[robot]` of a file, in which each sensor's table then names a type of `AnySense`.

    `RobotConfig` refuses entries that can have none.
    """
    sensors = robot.get("sensors")
    if not isinstance(sensors, Mapping):
        return dict(robot)
    return {**robot, "sensors": {name: _typed(entry) for name, entry in sensors.items()}}


def _typed(entry: Any) -> Any:
    kind = entry.get("type", Ultrasonic.type_name()) if isinstance(entry, Mapping) else None
    if isinstance(kind, str) and kind not in TYPES:
        return {"type": UnknownSensor.type_name(), "named": kind}
    return entry if kind is None else {**entry, "type": kind}
