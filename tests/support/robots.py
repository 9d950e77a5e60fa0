"""The robot that most tests are of: a stock Giraff's geometry, nothing soldered the other way round."""

import math
from typing import Final

import msgspec

from giraff_base.config import BaseConfig
from giraff_base.drives.wheels.config import WheelsConfig
from giraff_core.robot import RobotConfig
from giraff_core.senses import Bumper, Camera, LaserScanner, Ultrasonic

ULTRASONIC: Final = {
    "front_left": Ultrasonic(index=0, x=0.25, y=0.15, yaw=0.0),
    "front_right": Ultrasonic(index=1, x=0.25, y=-0.15, yaw=0.0),
    "rear": Ultrasonic(index=2, x=-0.25, y=0.0, yaw=math.pi),
}
ROBOT = RobotConfig(
    name="sim-test",
    track_width=0.47,
    ticks_per_metre=2002.0594,
    max_wheel_speed=0.6,
    max_angular_speed=1.57,
    footprint_radius=0.3,
    sensors={**ULTRASONIC},
)

BUMPED = msgspec.structs.replace(
    ROBOT,
    sensors=ROBOT.sensors | {"front": Bumper(index=0, way="forward"), "back": Bumper(index=1, way="backward")},
)
"""The same with a bumper at each half of its rim."""
FITTED = msgspec.structs.replace(
    BUMPED, sensors=BUMPED.sensors | {"head": Camera(z=1.0), "laser": LaserScanner(x=-0.1, y=0.0, yaw=0.0, own=())}
)
"""With all that a robot may have."""

DRIVE = WheelsConfig(
    max_level=70,
    battery_volts_per_count=0.03,
    swap_motors=False,
    swap_encoders=False,
    invert_left_motor=False,
    invert_right_motor=False,
    invert_left_encoder=False,
    invert_right_encoder=False,
)
BY_SPEED = msgspec.structs.replace(DRIVE, wheel_control="speed")
BASE = BaseConfig(port="unused", drive=DRIVE)
