"""What several services know of the robot: the table `[robot]` of the robot file."""

import math
from typing import Annotated, ClassVar, Final

import msgspec

from giraff_core.bounds import Bounds, check_bounds
from giraff_core.kinematics.calibration import Calibration
from giraff_core.kinematics.dead_reckoning import WHEEL_NOISE
from giraff_core.kinematics.differential_drive import DifferentialDrive
from giraff_core.kinematics.parts import ANGLE, PLACE, PartPose, check_parts, fixed_transform
from giraff_core.sensors import BUMPER, HC_SR04, ULTRASONIC, Bumper, Camera, UltrasonicModel
from giraff_core.tuning import Tuning
from giraff_schemas.frames import Transform, camera_frame, range_frame
from giraff_schemas.topics import require_chunk
from giraff_schemas.wire import RANGE_SENSORS

_STEEPEST: Final = math.pi / 4
WIRING: Final = (
    "swap_motors",
    "swap_encoders",
    "invert_left_motor",
    "invert_right_motor",
    "invert_left_encoder",
    "invert_right_encoder",
)
"""How motors and encoders are soldered."""


class SensorPose(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """An ultrasonic sensor in `base_link`: metres, radians.

    The guard and the simulation go by x, y and yaw: on a robot that stands upright each sensor looks level to them.
    They use z where a robot leans. roll and pitch are for who asks where its frame is.
    """

    index: int
    """Number of the sensor on the ranger board."""
    x: Annotated[float, PLACE]
    y: Annotated[float, PLACE]
    z: Annotated[float, Bounds(0.0, 2.0, "m", "how many metres above the floor is it?")] = 0.0
    """m above the floor. A robot that balances needs it: it leans, and the sensor looks at the floor then."""
    roll: Annotated[float, ANGLE] = 0.0
    """rad. About the fixed axes of `base_link`, first roll, then pitch, then yaw (REP-103)."""
    pitch: Annotated[float, Bounds(-_STEEPEST, _STEEPEST, "rad")] = 0.0
    """rad; positive: it looks down. One that looks more up or down than ahead says nothing of the way."""
    yaw: Annotated[float, ANGLE]
    scale: Annotated[float, Bounds(0.95, 1.05, "", "is this a percentage?")] = 1.0
    """Factor on each range that its echoes give: warm air and the board's clock are in it. `giraff calibrate ranger`
    measures it, with x and yaw."""

    def __post_init__(self) -> None:
        check_bounds(self)

    def transform(self, name: str) -> Transform:
        """Of the sensor of this name."""
        return fixed_transform(range_frame(name), self)


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
    sensors: dict[str, SensorPose] = {}
    """The ultrasonic ones, by name. In the robot file each table `[robot.sensors.<name>]` is of its `type`: those that
    have another one are in the tables below."""
    models: dict[str, UltrasonicModel] = {}
    """What is expected of those of `sensors` of which the robot file says so."""
    bumpers: dict[str, Bumper] = {}
    cameras: dict[str, Camera] = {}
    unknown_sensors: dict[str, str] = {}
    """By name: a type that this version does not know. Who does not use it passes it over."""
    frames: dict[str, PartPose] = {}
    """Of other parts, by name; odometry tells where they are."""

    def __post_init__(self) -> None:
        require_chunk(self.name)
        check_bounds(self)
        for sensor, pose in self.sensors.items():
            require_chunk(sensor)
            if not 0 <= pose.index < RANGE_SENSORS:
                raise ValueError(f"sensor {sensor} has index {pose.index}: the ranger board has 0..{RANGE_SENSORS - 1}")
        for sensor in (*self.bumpers, *self.cameras, *self.unknown_sensors):
            require_chunk(sensor)
        for mounted in (self.sensors, self.bumpers):
            indices = [each.index for each in mounted.values()]
            if len(set(indices)) != len(indices):
                raise ValueError(f"sensors share an index: {sorted(indices)}")
        check_parts(self.frames, [*map(range_frame, self.sensors), *map(camera_frame, self.cameras)])

    @property
    def sensor_types(self) -> dict[str, str]:
        """Return the type, as in the robot file, of each sensor that the guard listens to, by name."""
        return dict.fromkeys(self.sensors, ULTRASONIC) | dict.fromkeys(self.bumpers, BUMPER)

    @property
    def sensor_poses(self) -> dict[str, tuple[float, float, float]]:
        """The places of the ultrasonic sensors in `base_link`: m, m, rad."""
        return {name: (sensor.x, sensor.y, sensor.yaw) for name, sensor in self.sensors.items()}

    def camera(self, name: str, field: str) -> tuple[str, Camera]:
        """Return the name and the table of the camera that a name means; an empty one means the only one.

        `field`: where the name is written. Raises ValueError.
        """
        if name in self.cameras:
            return name, self.cameras[name]
        if not name and len(self.cameras) == 1:
            return next(iter(self.cameras.items()))
        for sensor, kind in self.unknown_sensors.items() if not self.cameras else ():
            raise ValueError(f'[robot.sensors.{sensor}] is of the type {kind!r}; write type = "camera" where it is one')
        if not self.cameras:
            raise ValueError(
                'the robot file has no camera; write [robot.sensors.head] with type = "camera" and its place'
            )
        whom = f"{field} is {name!r}" if name else f"{field} is empty"
        raise ValueError(f"{whom}, and the robot file's cameras are {', '.join(self.cameras)}: name one of them")

    def model(self, sensor: str) -> UltrasonicModel:
        """What is expected of an ultrasonic sensor."""
        return self.models.get(sensor, HC_SR04)

    @property
    def kinematics(self) -> DifferentialDrive:
        """How its wheels move it."""
        return DifferentialDrive(self.track_width * self.calibration.track_scale, self.max_wheel_speed)

    @property
    def left_ticks_per_metre(self) -> float:
        """Counts per metre that the left wheel truly rolls."""
        return self.ticks_per_metre / self.calibration.left_wheel_scale

    @property
    def right_ticks_per_metre(self) -> float:
        """The same of the right one."""
        return self.ticks_per_metre / self.calibration.right_wheel_scale
