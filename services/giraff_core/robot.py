"""What several services know of the robot: the table `[robot]` of the robot file."""

from __future__ import annotations

import math
from typing import Annotated, ClassVar, Final

import msgspec

from giraff_core.bounds import Bounds, check_bounds
from giraff_core.kinematics.calibration import Calibration
from giraff_core.kinematics.dead_reckoning import WHEEL_NOISE
from giraff_core.kinematics.differential_drive import DifferentialDrive
from giraff_core.kinematics.parts import ANGLE, PLACE, PartPose, check_parts
from giraff_core.tuning import Tuning
from giraff_core.wheel_control import UM_PER_M, SpeedControl, WheelControl, by_levels
from giraff_schemas.frames import BASE_FRAME, Transform, range_frame
from giraff_schemas.topics import require_chunk
from giraff_schemas.wire import RANGE_SENSORS, ConfigureFrame, Wiring

ADC_COUNTS: Final = 1023
"""The most that the base board reads of its battery."""
_STEEPEST: Final = math.pi / 4


class SensorPose(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """An ultrasonic sensor in `base_link`: metres, radians.

    The guard and the simulation go by x, y and yaw: to them each sensor looks level. z, roll and pitch are for who asks
    where its frame is.
    """

    index: int
    """Number of the sensor on the ranger board."""
    x: Annotated[float, PLACE]
    y: Annotated[float, PLACE]
    z: Annotated[float, PLACE] = 0.0
    """m up."""
    roll: Annotated[float, ANGLE] = 0.0
    """rad. About the fixed axes of `base_link`, first roll, then pitch, then yaw (REP-103)."""
    pitch: Annotated[float, Bounds(-_STEEPEST, _STEEPEST, "rad", "are these degrees?")] = 0.0
    """rad; positive: it looks down. One that looks more up or down than ahead says nothing of the way."""
    yaw: Annotated[float, ANGLE]

    def __post_init__(self) -> None:
        check_bounds(self)

    def transform(self, name: str) -> Transform:
        """Of the sensor of this name."""
        return Transform(
            parent=BASE_FRAME,
            child=range_frame(name),
            x=self.x,
            y=self.y,
            z=self.z,
            roll=self.roll,
            pitch=self.pitch,
            yaw=self.yaw,
            fixed=True,
        )


class RobotConfig(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Geometry, limits and wiring of one robot. SI units unless the name says otherwise."""

    LIVE: ClassVar = Tuning.READ_ONLY

    name: str
    track_width: Annotated[float, Bounds(0.05, 2.0, "m")]
    """m between the wheels' contact points, as built; `calibration` corrects it."""
    ticks_per_metre: Annotated[float, Bounds(50.0, 200_000.0, "1/m", "are these counts per millimetre?")]
    """Encoder counts of the base board (both edges of A) per metre of wheel travel, as built; `calibration` corrects
    it for each wheel."""
    max_wheel_speed: Annotated[float, Bounds(0.02, 5.0, "m/s")]
    """m/s of one wheel at `max_level`."""
    max_level: Annotated[int, Bounds(1, 255)]
    """Largest PWM level asked of a motor, of 255."""
    max_angular_speed: Annotated[float, Bounds(0.05, 20.0, "rad/s")]
    """rad/s."""
    footprint_radius: Annotated[float, Bounds(0.03, 2.0, "m")]
    """m: a disc about `base_link` that holds the whole robot."""
    battery_volts_per_count: Annotated[float, Bounds(0.0, 0.5, "V")]
    """V per ADC count of the base board; 0 = not calibrated, no battery is published."""
    battery_nominal: Annotated[float, Bounds(1.0, 100.0, "V")] = 24.0
    """V at which `max_level` stands for `max_wheel_speed`."""
    wheel_control: WheelControl = "level"
    """What base asks of its board: `level`, a PWM level that stands for a speed, or `speed`, which the board holds."""
    speed_control: SpeedControl = SpeedControl()
    """How the board holds a speed, where it is asked for one."""
    stall_level: Annotated[int, Bounds(1, 255)] = 25
    """Level from which a wheel that does not turn is stuck: one at which each wheel turns for certain, of 255."""
    # How motors and encoders are soldered. None: nobody has checked, and base does not arm.
    swap_motors: bool | None = None
    swap_encoders: bool | None = None
    invert_left_motor: bool | None = None
    invert_right_motor: bool | None = None
    invert_left_encoder: bool | None = None
    invert_right_encoder: bool | None = None
    calibration: Calibration = Calibration()
    """What this robot was measured to be. Of its wheels and track, nothing else is gone by."""
    wheel_noise: Annotated[float, Bounds(0.0, 0.1, "m")] = WHEEL_NOISE
    """m: variance (m²) of a wheel's travel per metre of it, of what is random. 1e-6 is 1 mm after one metre, 3 mm after
    ten; the recorded runs of a small robot leave 2e-7 to 1e-6. What is systematic: `calibration`."""
    sensors: dict[str, SensorPose]
    frames: dict[str, PartPose] = {}
    """Of other parts, by name; odometry tells where they are."""

    def __post_init__(self) -> None:
        require_chunk(self.name)
        check_bounds(self)
        if self.stall_level > self.max_level:
            raise ValueError(
                f"stall_level is {self.stall_level} and max_level {self.max_level}: "
                "no wheel would ever count as stuck; it must be max_level at most"
            )
        if self.asks_for_speeds:
            self._check_speed_control()
        for sensor, pose in self.sensors.items():
            require_chunk(sensor)
            if not 0 <= pose.index < RANGE_SENSORS:
                raise ValueError(f"sensor {sensor} has index {pose.index}: the ranger board has 0..{RANGE_SENSORS - 1}")
        indices = [pose.index for pose in self.sensors.values()]
        if len(set(indices)) != len(indices):
            raise ValueError(f"sensors share an index: {sorted(indices)}")
        check_parts(self.frames, [range_frame(sensor) for sensor in self.sensors])

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

    @property
    def asks_for_speeds(self) -> bool:
        """Whether the base board is asked for speeds; else for levels."""
        return self.wheel_control == "speed"

    @property
    def wiring_checked(self) -> bool:
        """Whether the robot file says how motors and encoders are soldered."""
        known = (self.swap_motors, self.swap_encoders, self.invert_left_motor, self.invert_right_motor)
        return None not in (*known, self.invert_left_encoder, self.invert_right_encoder)

    @property
    def wiring(self) -> Wiring:
        """The bits that the base board's `configure` frame carries; what is not checked counts as not set."""
        bits = (
            (self.swap_motors, Wiring.SWAP_MOTORS),
            (self.swap_encoders, Wiring.SWAP_ENCODERS),
            (self.invert_left_motor, Wiring.INVERT_LEFT_MOTOR),
            (self.invert_right_motor, Wiring.INVERT_RIGHT_MOTOR),
            (self.invert_left_encoder, Wiring.INVERT_LEFT_ENCODER),
            (self.invert_right_encoder, Wiring.INVERT_RIGHT_ENCODER),
        )
        result = Wiring(0)
        for is_set, bit in bits:
            if is_set:
                result |= bit
        return result

    def board_settings(self, acceleration: float) -> ConfigureFrame:
        """What the base board is told of this robot. `acceleration`: m/s² by which a wheel that is asked for a speed
        may get faster.
        """
        by_levels_only = msgspec.structs.replace(
            by_levels(self.wiring, self.max_level, self.stall_level),
            left_counts_per_km=round(self.left_ticks_per_metre * 1000),
            right_counts_per_km=round(self.right_ticks_per_metre * 1000),
        )
        if not self.asks_for_speeds:
            return by_levels_only
        control = self.speed_control
        # Rounded up: what is rounded of a speed within the limit is within it, too.
        fastest = math.ceil(self.max_wheel_speed * UM_PER_M)
        return msgspec.structs.replace(
            by_levels_only,
            level_max=0,
            speed_max_um_s=fastest,
            acceleration_um_s2=round(acceleration * UM_PER_M),
            nominal_um_s=fastest,
            nominal_level=self.max_level,
            nominal_adc_counts=self._nominal_adc_counts,
            motor_ms=round(control.motor_time * 1000),
            pwm_max=control.max_pwm,
            stall_pwm=control.stall_pwm,
            dead_pwm=control.dead_pwm,
            speed_p=round(control.speed_p),
            speed_i=round(control.speed_i),
            turn_p=round(control.turn_p),
            turn_i=round(control.turn_i),
        )

    @property
    def _nominal_adc_counts(self) -> int:
        """0 where the divider is not known."""
        return round(self.battery_nominal / self.battery_volts_per_count) if self.battery_volts_per_count else 0

    def _check_speed_control(self) -> None:
        """ValueError where what the board is to do is beyond it."""
        control = self.speed_control
        if self.max_level > control.max_pwm:
            raise ValueError(
                f"speed_control.max_pwm is {control.max_pwm} and max_level {self.max_level}: "
                "max_wheel_speed could not be reached; it must be max_level at least"
            )
        if self.stall_level > control.stall_pwm:
            raise ValueError(
                f"stall_level is {self.stall_level} and speed_control.stall_pwm {control.stall_pwm}: "
                "no wheel that stands would ever count as stuck; it must be stall_pwm at most"
            )
        if self._nominal_adc_counts > ADC_COUNTS:
            raise ValueError(
                f"battery_nominal is {self.battery_nominal:g} V, {self._nominal_adc_counts} counts by "
                f"battery_volts_per_count: the board reads {ADC_COUNTS} at most"
            )
