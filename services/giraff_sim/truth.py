"""What is true of one simulated robot, beside what its file says that it was built as.

Services know a robot by its file. No robot is its file: wheels are a little smaller, motors unlike each other, sensors
look aside. Nothing but the world reads a `Truth`, so that an error of the services' belief shows.
"""

import math
import random
from typing import Annotated, Final, Literal

import msgspec

from giraff_core.bounds import Bounds, check_bounds
from giraff_core.kinematics.calibration import Calibration
from giraff_core.senses import Camera
from giraff_schemas.wire import RANGE_SENSORS

Level = Literal["exact", "calibrated", "uncalibrated"]
"""How far a robot differs from its file: not at all, as one does after its calibration, or as one may before it."""

NEVER_CALIBRATED: Final = Calibration()

_SHARE: Final = Bounds(0.0, 0.3)


class TrueWheel(msgspec.Struct, frozen=True, kw_only=True):
    """A wheel, its motor and its encoder."""

    scale: float = 1.0
    """m truly rolled for each metre that the file's `ticks_per_metre` makes of the encoder's counts."""
    strength: float = 1.0
    """Of the speed that the file expects at a level."""
    drag: float = 0.0
    """m/s² by which the floor holds it more than the one on which the file's speeds were measured."""
    phase: float = 0.0
    """Where between two counts, 0..1, the encoder stands at power-on."""
    threshold_slip: float = 0.0
    """m that it turns in vain on each threshold."""


class TrueCamera(msgspec.Struct, frozen=True, kw_only=True):
    """Every camera of the robot."""

    height_scale: float = 1.0
    """True height above the floor, as a multiple of the robot file's."""
    pitch: float = 0.0
    """rad that it looks farther down."""
    focal_scale: float = 1.0
    distortion: tuple[float, float, float, float, float] = (0.0, 0.0, 0.0, 0.0, 0.0)
    """k1, k2, p1, p2, k3 beyond the file's."""

    def of(self, camera: Camera) -> Camera:
        """Return the true one of a camera in the file."""
        return msgspec.structs.replace(
            camera,
            z=camera.z * self.height_scale,
            pitch=min(math.pi / 2, max(-math.pi / 2, camera.pitch + self.pitch)),
            focal_x=camera.focal_x * self.focal_scale,
            focal_y=camera.focal_y * self.focal_scale,
            distortion=tuple(map(sum, zip(camera.distortion, self.distortion, strict=True))),
        )


class Truth(msgspec.Struct, frozen=True, kw_only=True):
    """One robot. The defaults are a robot that is exactly as built, whatever a calibration says."""

    left: TrueWheel = TrueWheel()
    right: TrueWheel = TrueWheel()
    track_scale: float = 1.0
    """Of the file's `track_width`."""
    turn_slip: float = 0.0
    """Share of each turn that the wheels make and the body does not."""
    accelerometer_offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """m/s² that the joystick's sensor reads too much, along each axis of its own."""
    sonar_noise: float = 0.0
    """m, standard deviation of a range."""
    sensor_yaws: tuple[float, ...] = (0.0,) * RANGE_SENSORS
    """rad by which each ultrasonic sensor, by its number on the ranger board, looks to the left of the file's `yaw`."""
    sensor_xs: tuple[float, ...] = (0.0,) * RANGE_SENSORS
    """m by which each of them sits farther ahead than the file's `x`."""
    sonar_scales: tuple[float, ...] = (1.0,) * RANGE_SENSORS
    """m truly there for each metre that the echo of each of them gives by the file's `scale`."""
    camera: TrueCamera = TrueCamera()


EXACT: Final = Truth()


class TruthRanges(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The table `[sim.truth]` of the robot file: within what a simulated robot is drawn, evenly unless it says so."""

    wheel_scale: Annotated[float, _SHARE] = 0.02
    """Share by which either wheel may be larger or smaller than the file says."""
    track_scale: Annotated[float, _SHARE] = 0.03
    """The same of the track."""
    calibrated_wheel_scale: Annotated[float, _SHARE] = 0.001
    """What a calibration leaves of `wheel_scale`."""
    calibrated_track_scale: Annotated[float, _SHARE] = 0.003
    """What it leaves of `track_scale`."""
    motor_weakness: Annotated[float, _SHARE] = 0.15
    """Share by which either motor may be weaker than the file says."""
    drag: Annotated[float, Bounds(0.0, 1.0, "m/s²")] = 0.1
    """m/s², at most, by which a carpet holds both wheels more than a hard floor: an estimate."""
    turn_slip: Annotated[float, _SHARE] = 0.01
    """Largest share of a turn that is lost: an estimate, for castors that scrub."""
    threshold_slip: Annotated[float, Bounds(0.0, 0.1, "m")] = 0.02
    """m that a wheel turns in vain on a threshold, at most: an estimate."""
    accelerometer_offset: Annotated[float, Bounds(0.0, 2.0, "m/s²")] = 0.3
    """m/s², either way, of each axis."""
    sonar_noise: Annotated[float, Bounds(0.0, 0.5, "m")] = 0.01
    """m, standard deviation of a range: the same of every drawn robot."""
    sensor_yaw: Annotated[float, Bounds(0.0, math.pi / 6, "rad")] = math.radians(3.0)
    """rad, to either side, of each sensor's axis."""
    sensor_x: Annotated[float, Bounds(0.0, 0.2, "m")] = 0.0
    """m by which each ultrasonic sensor may sit farther ahead or back than the file says."""
    sonar_scale: Annotated[float, Bounds(0.0, 0.05)] = 0.0
    """Share by which a metre of each sensor's echo may be more or less than one."""
    camera_height: Annotated[float, Bounds(0.0, 0.2)] = 0.03
    """Share by which a camera may be higher or lower than the file says."""
    camera_pitch: Annotated[float, Bounds(0.0, math.pi / 12, "rad")] = math.radians(2.0)
    """rad, up or down."""
    camera_focal: Annotated[float, Bounds(0.0, 0.2)] = 0.03
    """Share of the focal length, either way."""
    camera_distortion: Annotated[float, Bounds(0.0, 0.2)] = 0.1
    """k1 of the lens, either way. k2 is drawn within a third of it, p1 and p2 within a fiftieth."""
    calibrated_camera: Annotated[float, Bounds(0.0, 1.0)] = 0.1
    """Share of those four that a calibration leaves."""

    def __post_init__(self) -> None:
        check_bounds(self)
        for name, largest in (
            ("calibrated_wheel_scale", self.wheel_scale),
            ("calibrated_track_scale", self.track_scale),
        ):
            if getattr(self, name) > largest:
                raise ValueError(f"{name} is {getattr(self, name):g}: it must be {largest:g} at most")


def draw_truth(level: Level, ranges: TruthRanges, seed: int, calibration: Calibration = NEVER_CALIBRATED) -> Truth:
    """The robot of this seed: calibrated and not, it is the same one.

    An uncalibrated one is drawn around what it was built as, so that a calibration does not change what is true. The
    others are what `calibration`, the file's, takes them for, or near it.
    """
    if level == "exact":
        return _as_calibrated(calibration)
    chance = random.Random(f"{seed}/truth")
    is_calibrated = level == "calibrated"
    wheel_scale = ranges.calibrated_wheel_scale if is_calibrated else ranges.wheel_scale
    track_scale = ranges.calibrated_track_scale if is_calibrated else ranges.track_scale
    middle = _as_calibrated(calibration) if is_calibrated else EXACT

    def around(value: float, share: float) -> float:
        return value * (1.0 + either_way(share))

    def either_way(largest: float) -> float:
        return chance.uniform(-largest, largest)

    mounts = random.Random(f"{seed}/mounts")  # of its own, as the camera's
    drag = random.Random(f"{seed}/drag").uniform(0.0, ranges.drag)

    def wheel(scale: float) -> TrueWheel:
        return TrueWheel(
            drag=drag,
            scale=around(scale, wheel_scale),
            strength=1.0 - chance.uniform(0.0, ranges.motor_weakness),
            phase=chance.random(),
            threshold_slip=chance.uniform(0.0, ranges.threshold_slip),
        )

    offset = ranges.accelerometer_offset
    drawn = Truth(
        left=wheel(middle.left.scale),
        right=wheel(middle.right.scale),
        track_scale=around(middle.track_scale, track_scale),
        turn_slip=chance.uniform(0.0, ranges.turn_slip),
        accelerometer_offset=(either_way(offset), either_way(offset), either_way(offset)),
        sonar_noise=ranges.sonar_noise,
        sensor_yaws=tuple(either_way(ranges.sensor_yaw) for _ in range(RANGE_SENSORS)),
        sensor_xs=tuple(mounts.uniform(-ranges.sensor_x, ranges.sensor_x) for _ in range(RANGE_SENSORS)),
        sonar_scales=tuple(1.0 + mounts.uniform(-ranges.sonar_scale, ranges.sonar_scale) for _ in range(RANGE_SENSORS)),
        camera=_draw_camera(ranges, seed, ranges.calibrated_camera if is_calibrated else 1.0),
    )
    if is_calibrated and calibration.date:  # a track that was measured by turning has what slips in it
        return msgspec.structs.replace(drawn, track_scale=drawn.track_scale * (1.0 - drawn.turn_slip))
    return drawn


def _draw_camera(ranges: TruthRanges, seed: int, share: float) -> TrueCamera:
    """Draw by a chance of its own, so that a seed draws the same robot as before there were cameras."""
    chance = random.Random(f"{seed}/camera")

    def either_way(largest: float) -> float:
        return chance.uniform(-largest, largest) * share

    bend = ranges.camera_distortion
    return TrueCamera(
        height_scale=1.0 + either_way(ranges.camera_height),
        pitch=either_way(ranges.camera_pitch),
        focal_scale=1.0 + either_way(ranges.camera_focal),
        distortion=(either_way(bend), either_way(bend / 3.0), either_way(bend / 50.0), either_way(bend / 50.0), 0.0),
    )


def _as_calibrated(calibration: Calibration) -> Truth:
    """Exactly."""
    return Truth(
        left=TrueWheel(scale=calibration.left_wheel_scale),
        right=TrueWheel(scale=calibration.right_wheel_scale),
        track_scale=calibration.track_scale,
    )
