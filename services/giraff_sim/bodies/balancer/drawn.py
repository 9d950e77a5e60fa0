"""One simulated robot that balances: how its true body, motors and sensors differ from the robot file.

The spreads are estimates: no robot was measured.
"""

import math
import random
from dataclasses import dataclass, replace
from typing import Any, Final

from giraff_base.drives.balancer.config import BalancerConfig

Pair = tuple[float, float]
"""Values of the left and of the right wheel, or of both axes of the gyroscope."""

_VOLTS: Final = 12.6 / 12.0  # of a full battery, for each V of its name
_SAG: Final = 0.15  # of the battery with both motors stalled
AMPERES: Final = 50.0
"""A. The motor driver's limit for each motor."""


@dataclass(frozen=True, slots=True)
class Drawn:
    """True values of one robot. SI units. Torques and inertias of motors are those seen at the wheel."""

    body_mass: float
    centre_height: float
    body_inertia: float
    wheel_mass: float
    wheel_inertia: float
    radius: float
    track: float
    yaw_inertia: float
    rotor_inertia: float
    constant: Pair
    ohm: Pair
    friction: Pair
    load_loss: Pair
    """Share of a gear's torque that friction takes."""
    play: Pair
    """rad between the two ends of each gear's play."""
    rolling: float
    """Rolling resistance, of the load."""
    grip: float
    caster: float
    """rad of lean against the floor at which a caster touches it."""
    open_volts: float
    battery_ohm: float
    delay: int
    """ms from a packet of the board to the bridge, beside the packet's time on the line."""
    accelerometer_zero: float
    """rad."""
    accelerometer_drift: float
    """rad in ten minutes."""
    gyro_zero: Pair
    """rad/s."""
    gyro_drift: Pair
    """rad/s while it warms up, in three minutes."""
    gyro_gain: Pair
    sensor_height: float
    """m above the axle."""

    @property
    def told(self) -> str:
        """Return in words, in two lines, what a person compares with the file."""
        play, zero = math.degrees(max(self.play)), math.degrees(self.accelerometer_zero)
        return f"{self.body_mass:.1f} kg at {self.centre_height:.3f} m, gear play {play:.1f}°,\nzero {zero:+.1f}°"


def draw(drive: BalancerConfig, track: float, seed: int, spread: float = 1.0, **fixed: Any) -> Drawn:
    """Draw one robot around its file. `spread`: 0 draws the nominal robot. `fixed` sets fields."""
    chance = random.Random(f"balancer {seed}")

    def off(bound: float) -> float:
        return chance.uniform(-bound, bound) * spread

    def about(nominal: float, share: float) -> float:
        return nominal * (1.0 + off(share))

    def pair(nominal: float, share: float) -> Pair:
        return about(nominal, share), about(nominal, share)

    stall = min(drive.battery_nominal / drive.motor_resistance, AMPERES)
    return replace(
        Drawn(
            body_mass=about(drive.body_mass, 0.10),
            centre_height=about(drive.centre_height, 0.15),
            body_inertia=about(drive.body_inertia, 0.20),
            wheel_mass=drive.wheel_mass,
            wheel_inertia=about(drive.wheel_inertia, 0.20),
            radius=about(drive.wheel_radius, 0.01),
            track=about(track, 0.01),
            yaw_inertia=about(1.6, 0.20),
            rotor_inertia=about(drive.rotor_inertia, 0.25),
            constant=pair(drive.motor_constant, 0.04),
            ohm=pair(drive.motor_resistance, 0.15),
            friction=pair(drive.friction, 0.40),
            load_loss=pair(0.2, 0.40),
            play=pair(math.radians(1.5), 0.33),
            rolling=about(0.02, 0.50),
            grip=about(0.7, 0.20),
            caster=about(math.radians(13.5), 0.11),
            open_volts=drive.battery_nominal * (_VOLTS + off(0.2 / 12.0)),
            battery_ohm=_SAG * drive.battery_nominal / (2.0 * stall),
            delay=round(3.0 + off(2.0)),
            accelerometer_zero=off(math.radians(2.0)),
            accelerometer_drift=off(math.radians(0.3)),
            gyro_zero=(off(math.radians(3.0)), off(math.radians(3.0))),
            gyro_drift=(off(math.radians(2.0)), off(math.radians(2.0))),
            gyro_gain=pair(1.0, 0.05),
            sensor_height=0.03 + off(0.03),
        ),
        **fixed,
    )
