"""What several services know of the robot: the table `[robot]` of the robot file."""

from typing import Annotated, ClassVar, Final, TypeVar

import msgspec

from giraff_core.bounds import Bounds, check_bounds
from giraff_core.kinematics.calibration import Calibration
from giraff_core.kinematics.dead_reckoning import WHEEL_NOISE
from giraff_core.kinematics.differential_drive import DifferentialDrive
from giraff_core.kinematics.parts import PartPose, check_parts
from giraff_core.senses import SENSES, AnySense, Camera, Sense, UnknownSensor
from giraff_core.tuning import Tuning
from giraff_schemas.frames import Transform
from giraff_schemas.topics import require_chunk

SenseT = TypeVar("SenseT", bound=Sense)
PASSAGE: Final = 0.15
"""m beyond the footprint that a route has at each side. Measured with the guard, for each sense: docs/obstacles.md."""
WIRING: Final = (
    "swap_motors",
    "swap_encoders",
    "invert_left_motor",
    "invert_right_motor",
    "invert_left_encoder",
    "invert_right_encoder",
)
"""How motors and encoders are soldered."""


class RobotConfig(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Geometry and limits of one robot. SI units unless the name says otherwise."""

    LIVE: ClassVar = Tuning.READ_ONLY

    name: str
    track_width: Annotated[float, Bounds(0.05, 2.0, "m")]
    """m between the wheels' contact points, as built; `calibration` corrects it."""
    ticks_per_metre: Annotated[float, Bounds(50.0, 200_000.0, "1/m", "are these counts per millimetre?")]
    """Encoder counts of the base board (both edges of A) per metre of wheel travel, as built; `calibration` corrects
    it for each wheel."""
    max_wheel_speed: Annotated[float, Bounds(0.02, 5.0, "m/s")]
    """m/s of one wheel at `max_level`."""
    max_angular_speed: Annotated[float, Bounds(0.05, 20.0, "rad/s")]
    """rad/s."""
    footprint_radius: Annotated[float, Bounds(0.03, 2.0, "m")]
    """m: a disc about `base_link` that holds the whole robot."""
    calibration: Calibration = Calibration()
    """What this robot was measured to be. Of its wheels and track, nothing else is gone by."""
    wheel_noise: Annotated[float, Bounds(0.0, 0.1, "m")] = WHEEL_NOISE
    """m: variance (m²) of a wheel's travel per metre of it, of what is random. 1e-6 is 1 mm after one metre, 3 mm after
    ten; the recorded runs of a small robot leave 2e-7 to 1e-6. What is systematic: `calibration`."""
    sensors: dict[str, AnySense] = {}
    """By name. In the robot file, one without a `type` is an ultrasonic one."""
    frames: dict[str, PartPose] = {}
    """Of other parts, by name; odometry tells where they are."""

    def __post_init__(self) -> None:
        require_chunk(self.name)
        check_bounds(self)
        for name in self.sensors:
            require_chunk(name)
        for kind in SENSES:
            indices = [index for each in self.of(kind).values() if (index := getattr(each, "index", None)) is not None]
            if len(set(indices)) != len(indices):
                raise ValueError(f"sensors share an index: {sorted(indices)}")
        check_parts(self.frames, [place.child for place in self.sensor_transforms.values()])

    def of(self, kind: type[SenseT]) -> dict[str, SenseT]:
        """Return the sensors of a type, by name."""
        return {name: sensor for name, sensor in self.sensors.items() if isinstance(sensor, kind)}

    @property
    def sensor_types(self) -> dict[str, str]:
        """Return the type, as in the robot file, of each sensor that the guard listens to, by name."""
        return {name: sensor.type_name() for name, sensor in self.sensors.items() if sensor.TOPIC is not None}

    @property
    def sensor_transforms(self) -> dict[str, Transform]:
        """Return where each sensor is that has a place, by name."""
        places = {name: sensor.transform(name) for name, sensor in self.sensors.items()}
        return {name: place for name, place in places.items() if place is not None}

    def camera(self, name: str, field: str) -> tuple[str, Camera]:
        """Return the name and the table of the camera that a name means; an empty one means the only one.

        `field`: where the name is written. Raises ValueError.
        """
        cameras = self.of(Camera)
        if name in cameras:
            return name, cameras[name]
        if not name and len(cameras) == 1:
            return next(iter(cameras.items()))
        for sensor, unknown in self.of(UnknownSensor).items() if not cameras else ():
            raise ValueError(
                f'[robot.sensors.{sensor}] is of the type {unknown.named!r}; write type = "camera" where it is one'
            )
        if not cameras:
            raise ValueError(
                'the robot file has no camera; write [robot.sensors.head] with type = "camera" and its place'
            )
        whom = f"{field} is {name!r}" if name else f"{field} is empty"
        raise ValueError(f"{whom}, and the robot file's cameras are {', '.join(cameras)}: name one of them")

    @property
    def kinematics(self) -> DifferentialDrive:
        """How its wheels move it."""
        return DifferentialDrive(self.track_width * self.calibration.track_scale, self.max_wheel_speed)

    @property
    def passage_radius(self) -> float:
        """m. Half of the narrowest door that a route goes through."""
        return self.footprint_radius + PASSAGE

    @property
    def left_ticks_per_metre(self) -> float:
        """Counts per metre that the left wheel truly rolls."""
        return self.ticks_per_metre / self.calibration.left_wheel_scale

    @property
    def right_ticks_per_metre(self) -> float:
        """The same of the right one."""
        return self.ticks_per_metre / self.calibration.right_wheel_scale
