"""The table `[sim]` of the robot file: what is true of the simulated robot and unknown of a real one."""

from __future__ import annotations

import math

import msgspec


class SimConfig(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """SI units unless the name says otherwise. The defaults are a Giraff's, as far as they are known."""

    motor_time_constant: float = 0.15
    """s."""
    wheel_friction: float = 0.6
    """m/s^2 at the wheel's rim, against its motion."""
    dead_zone_counts: float = 4.0
    """PWM counts of 255 below which a motor only hums."""
    battery_volts: float = 24.5
    """V with nothing connected."""
    battery_nominal_volts: float = 24.0
    """V at which `max_level` stands for `max_wheel_speed`."""
    battery_sag_volts: float = 2.0
    """V lost with both motors at full duty."""
    sonar_noise: float = 0.001
    """m, standard deviation of a range."""
    sonar_crosstalk: float = 0.0
    """Share of pings that hear another robot's: a range that is too short."""
    tilt_noise: float = 0.02
    """m/s^2, standard deviation of each axis of the accelerometer."""

    def __post_init__(self) -> None:
        for name in ("motor_time_constant", "battery_volts", "battery_nominal_volts"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0.0):
                raise ValueError(f"{name} is {value}: it must be a positive number")
        for name in ("wheel_friction", "dead_zone_counts", "battery_sag_volts", "sonar_noise", "tilt_noise"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value >= 0.0):
                raise ValueError(f"{name} is {value}: it must be zero or a positive number")
        if not 0.0 <= self.sonar_crosstalk <= 1.0:
            raise ValueError(f"sonar_crosstalk is {self.sonar_crosstalk}: it must be in 0..1")
