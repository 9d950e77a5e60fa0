"""The table `[sim]` of the robot file: what is true of every simulated robot and unknown of a real one."""

import math

import msgspec

from giraff_core.bounds import require_not_negative, require_positive
from giraff_sim.truth import TruthRanges

_STEEPEST = 20.0  # deg: no robot on two wheels climbs it


class SimConfig(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """SI units unless the name says otherwise. The defaults are a Giraff's, as far as they are known."""

    motor_time_constant: float = 0.15
    """s."""
    wheel_friction: float = 0.6
    """m/s^2 at the wheel's rim, against its motion."""
    slope_deg: float = 0.0
    """deg by which the floor rises along +x of the room, under a robot on two wheels. 3: a wheelchair ramp."""
    dead_zone_counts: float = 4.0
    """PWM counts of 255 below which a motor only hums."""
    battery_volts: float = 24.5
    """V with nothing connected."""
    battery_hours: float = 0.0
    """h in which the battery loses a fifth of its V, evenly, driven or not: 24.5 V become 19.6. 0: it never empties."""
    battery_sag_volts: float = 2.0
    """V lost with both motors at full duty."""
    encoder_disk: str = ""
    """Path of a drawing by `giraff encoder disk`. Both encoders read it; empty: they read an ideal disk."""
    sonar_crosstalk: float = 0.0
    """Share of pings that hear another robot's: a range that is too short."""
    tilt_noise: float = 0.02
    """m/s^2, standard deviation of each axis of the accelerometer."""
    hand_tremor: float = 0.05
    """m/s^2, rms of each axis, of the hand that holds the joystick. Most people's is about 0.07 at its main frequency
    (Arch Neurol 1982;39:358-362), over the axes it is shared by."""
    truth: TruthRanges = TruthRanges()
    """How far the robot may differ from its file."""

    def __post_init__(self) -> None:
        require_positive(self, "motor_time_constant", "battery_volts")
        require_not_negative(
            self,
            "wheel_friction",
            "dead_zone_counts",
            "battery_hours",
            "battery_sag_volts",
            "tilt_noise",
            "hand_tremor",
        )
        if not math.fabs(self.slope_deg) <= _STEEPEST:
            raise ValueError(f"slope_deg is {self.slope_deg}: it must be in -{_STEEPEST:g}..{_STEEPEST:g}")
        if not 0.0 <= self.sonar_crosstalk <= 1.0:
            raise ValueError(f"sonar_crosstalk is {self.sonar_crosstalk}: it must be in 0..1")
