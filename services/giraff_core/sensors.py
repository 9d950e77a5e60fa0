"""The robot's sensors: `[robot.sensors.<name>]` of the robot file, by their `type`.

`RobotConfig` has a table for each type.
"""

import math
from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Final, Literal

import msgspec

from giraff_core.bounds import Bounds, check_bounds
from giraff_core.kinematics.parts import ANGLE, PLACE, fixed_transform
from giraff_core.tuning import Tuning
from giraff_schemas import topics
from giraff_schemas.frames import Transform, camera_frame
from giraff_schemas.wires.bumper import BUMPERS

ULTRASONIC: Final = "hc-sr04"
"""The type of a sensor that names none."""
BUMPER: Final = "bumper"
_TABLES: Final = {BUMPER: "bumpers", "camera": "cameras"}
"""By type, the table of `RobotConfig` that holds all of it."""
TYPES: Final = (*_TABLES, ULTRASONIC)
TABLES: Final = ("sensors", "models", *_TABLES.values())
"""The fields of `RobotConfig` that hold what `[robot.sensors]` of a file says."""
SORTED: Final = (*TABLES[1:], "unknown_sensors")
"""Fields of `RobotConfig` that no file has: `by_type` fills them."""

SENSED: Final[dict[str, topics.Topic[Any]]] = {"sensors": topics.RANGE, "bumpers": topics.BUMPER}
"""Topic of the sensors of each table in `RobotConfig`. Guard and replay read the topics in this order."""


class UltrasonicModel(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What guard and localization expect of an ultrasonic sensor: the defaults are of an HC-SR04.

    The simulator has a model of its own, which is drawn by `[sim.truth]`.
    """

    LIVE: ClassVar = Tuning.READ_ONLY

    half_cone: Annotated[float, Bounds(math.radians(1.0), math.radians(45.0), "rad")] = math.radians(7.5)
    """rad; an echo may come from anywhere this far off the sensor's axis."""
    incidence: Annotated[float, Bounds(math.radians(5.0), math.radians(85.0), "rad")] = math.radians(25.0)
    """rad between a surface's normal and the sensor's axis, up to which it reads reliably."""
    reach: Annotated[float, Bounds(0.1, 10.0, "m")] = 4.0
    """m beyond which nothing is heard: what `clear` counts for."""

    def __post_init__(self) -> None:
        check_bounds(self)


HC_SR04: Final = UltrasonicModel()


class Bumper(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A switch at the robot's rim that opens when something pushes it, on a spare pin of the ranger's board."""

    LIVE: ClassVar = Tuning.READ_ONLY

    index: int
    """Number of the pin on the ranger board."""
    way: Literal["forward", "backward"]
    """The way that the robot drives when it meets something with it."""

    def __post_init__(self) -> None:
        if not 0 <= self.index < BUMPERS:
            raise ValueError(f"index is {self.index}: the ranger board has bumpers 0..{BUMPERS - 1}")


class Camera(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A camera in `base_link` (metres, radians), and its lens. `giraff calibrate camera` measures what is here.

    The lens is that of a plumb-bob model, as ROS and OpenCV have it: pixels from the middle of the left upper one.
    """

    LIVE: ClassVar = Tuning.READ_ONLY

    x: Annotated[float, PLACE] = 0.0
    y: Annotated[float, PLACE] = 0.0
    z: Annotated[float, Bounds(0.02, 3.0, "m", "how high above the floor is its lens?")]
    """m above the floor."""
    roll: Annotated[float, ANGLE] = 0.0
    """rad. About the fixed axes of `base_link`, first roll, then pitch, then yaw (REP-103)."""
    pitch: Annotated[float, Bounds(-math.pi / 2, math.pi / 2, "rad")] = 0.0
    """rad; positive: it looks down."""
    yaw: Annotated[float, ANGLE] = 0.0
    width: Annotated[int, Bounds(64, 1920, "px")] = 320
    height: Annotated[int, Bounds(48, 1080, "px")] = 240
    focal_x: Annotated[float, Bounds(10.0, 10_000.0, "px")] = 230.0
    """px, at this width; 230 of 320 is 70 degrees wide."""
    focal_y: Annotated[float, Bounds(10.0, 10_000.0, "px")] = 230.0
    center_x: Annotated[float | None, Bounds(0.0, 1920.0, "px")] = None
    """px; None: the picture's middle."""
    center_y: Annotated[float | None, Bounds(0.0, 1080.0, "px")] = None
    distortion: tuple[float, float, float, float, float] = (0.0, 0.0, 0.0, 0.0, 0.0)
    """k1, k2, p1, p2, k3."""

    def __post_init__(self) -> None:
        check_bounds(self)
        if not all(math.isfinite(value) for value in self.distortion):
            raise ValueError("distortion has a number that is not finite")

    def transform(self, name: str) -> Transform:
        """Return the transform of the camera of this name."""
        return fixed_transform(camera_frame(name), self)


def by_type(robot: Mapping[str, Any]) -> dict[str, Any]:
    """The table `[robot]` of a file, with each sensor in the table of its type, as `RobotConfig` has them.

    Raises ValueError.
    """
    for table in SORTED:
        if table in robot:
            raise ValueError(f"{table} is no table of a file; write [robot.sensors.<name>], with its type")
    sensors = robot.get("sensors")
    if not isinstance(sensors, Mapping):
        return dict(robot)
    found: dict[str, dict[str, Any]] = {table: {} for table in (*TABLES, "unknown_sensors")}
    for name, entry in sensors.items():
        if not isinstance(entry, Mapping):
            found["sensors"][name] = entry  # refused there
            continue
        kind, rest = entry.get("type", ULTRASONIC), {field: entry[field] for field in entry if field != "type"}
        if kind == ULTRASONIC:
            model = {field: rest.pop(field) for field in UltrasonicModel.__struct_fields__ if field in rest}
            found["sensors"][name] = rest
            found["models"] |= {name: model} if model else {}
        else:
            if not isinstance(kind, str):
                raise ValueError(f"the type of the sensor {name} is {kind!r}, which is no text")
            table = _TABLES.get(kind, "unknown_sensors")
            found[table][name] = rest if kind in _TABLES else kind
    return {**robot, **{table: entries for table, entries in found.items() if entries or table == "sensors"}}
