"""The table `[base.drive]` of two wheels: their motors, as the board on `firmware/base` drives them."""

import math
from typing import Annotated, ClassVar, Final, Literal

import msgspec

from giraff_base.drives.wheel_wiring import CHECK_THEM, WheelWiring
from giraff_core.bounds import Bounds, check_bounds
from giraff_core.robot import RobotConfig
from giraff_core.tuning import Tuning
from giraff_schemas.boards import BASE_BOARD, BaseBoardName, BoardType, boards_chosen_in
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_schemas.wire import PROTOCOL_HASH, ConfigureFrame, Wiring

WheelControl = Literal["level", "speed"]
"""`level`: open loop, a level stands for a speed. `speed`: the board's loops hold what is asked."""

_GAIN: Final = Bounds(0.0, 3900.0)  # 16 bits of the board's fixed point
UM_PER_M: Final = 1e6
"""The board counts in whole micrometres."""
ADC_COUNTS: Final = 1023
"""The most that the base board reads of its battery."""


class SpeedControl(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The table `[base.drive.speed_control]`: the base board's two wheel loops and the turn loop that couples them.

    The defaults are for a motor of 0.15 s time constant that turns a wheel at 0.6 m/s at level 70: each loop's zero
    lies on the motor's pole, and closes at 0.1 s.
    """

    max_pwm: Annotated[int, Bounds(1, 255)] = 110
    """Most PWM counts that a wheel gets, of 255: what `max_wheel_speed` takes of a weak motor and a low battery."""
    stall_pwm: Annotated[int, Bounds(1, 255)] = 40
    """Most that a wheel gets while it stands. It bounds the force on whoever is in its way."""
    dead_pwm: Annotated[int, Bounds(0, 255)] = 5
    """Least that a wheel gets that is to turn: below it the motor only hums."""
    motor_time: Annotated[float, Bounds(0.0, 2.0, "s")] = 0.15
    """s; time constant of a motor with its share of the robot, for the push that speeding up takes. 0: none."""
    speed_p: Annotated[float, _GAIN] = 175.0
    """PWM counts for each m/s that a wheel is too slow."""
    speed_i: Annotated[float, _GAIN] = 1170.0
    """PWM counts for each m that it is behind."""
    turn_p: Annotated[float, _GAIN] = 50.0
    """PWM counts, to the right wheel and from the left one, for each m/s that the right one is too slow against it."""
    turn_i: Annotated[float, _GAIN] = 400.0
    """PWM counts for each m that it is behind."""

    def __post_init__(self) -> None:
        check_bounds(self)
        if self.stall_pwm > self.max_pwm:
            raise ValueError(f"stall_pwm is {self.stall_pwm}: it must be max_pwm at most, which is {self.max_pwm}")
        if self.dead_pwm > self.stall_pwm:
            raise ValueError(f"dead_pwm is {self.dead_pwm}: it must be stall_pwm at most, which is {self.stall_pwm}")


def by_levels(wiring: Wiring, level_max: int, stall_level: int) -> ConfigureFrame:
    """Settings of a session that takes levels up to `level_max`, of 255, and tells no speeds.

    They name no boot and no session yet: `WheelsCommands.configure` does.
    """
    return ConfigureFrame(
        seq=0,
        protocol_hash=PROTOCOL_HASH,
        boot_id=0,
        board_ms=0,
        session=0,
        wiring=wiring,
        level_max=level_max,
        stall_level=stall_level,
        left_counts_per_km=0,
        right_counts_per_km=0,
        speed_max_um_s=0,
        acceleration_um_s2=0,
        nominal_um_s=0,
        nominal_level=0,
        nominal_adc_counts=0,
        motor_ms=0,
        pwm_max=0,
        stall_pwm=0,
        dead_pwm=0,
        speed_p=0,
        speed_i=0,
        turn_p=0,
        turn_i=0,
    )


class WheelsConfig(WheelWiring, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="type", tag="wheels"):
    """Motors, battery and wiring of a robot on two driven wheels."""

    LIVE: ClassVar = Tuning.READ_ONLY
    battery_minimum: ClassVar[float] = 0.0
    """V. The board needs none: this robot stands on a flat battery, too."""

    board: BaseBoardName = "base"
    """Board that drives the motors and counts the edges: an ATmega644 with two H bridges (`base`); an Arduino Mega with
    servo pulses (`ardros`), an L298N or TB6612FNG (`mega_l298n`), or two BTS7960 (`mega_bts7960`); or a motor
    controller with a process before it on the robot's computer (`roboclaw`, `ros_arduino_bridge`)."""
    max_level: Annotated[int, Bounds(1, 255)]
    """Largest PWM level asked of a motor, of 255: the one that stands for `max_wheel_speed`."""
    battery_volts_per_count: Annotated[float, Bounds(0.0, 0.5, "V")] = 0.0
    """V per ADC count of the base board. 0: not measured. Then no battery is published, and a robot whose board holds
    speeds drives at max_wheel_speed / 1.5 at most: if both encoders lost counts, nothing would bound it sooner."""
    battery_nominal: Annotated[float, Bounds(1.0, 100.0, "V")] = 24.0
    """V at which `max_level` stands for `max_wheel_speed`."""
    wheel_control: WheelControl = "level"
    """What base asks of its board: `level`, a PWM level that stands for a speed, or `speed`, which the board holds."""
    speed_control: SpeedControl = SpeedControl()
    """How the board holds a speed, where it is asked for one."""
    stall_level: Annotated[int, Bounds(1, 255)] = 25
    """Level from which a wheel that does not turn is stuck: one at which each wheel turns for certain, of 255."""

    def __post_init__(self) -> None:
        check_bounds(self)
        if self.stall_level > self.max_level:
            raise ValueError(
                f"stall_level is {self.stall_level} and max_level {self.max_level}: "
                "no wheel would ever count as stuck; it must be max_level at most"
            )
        if self.battery_volts_per_count and not self.board_type.measures_battery:
            raise ValueError(
                f"battery_volts_per_count is {self.battery_volts_per_count}: "
                f"the board {self.board} measures no battery; leave it out"
            )
        if self.asks_for_speeds and self.board_type.loop_hz:
            raise ValueError(
                f'wheel_control is "speed": the controller behind the board {self.board} holds speeds by a loop of its '
                "own; leave it out"
            )
        if self.asks_for_speeds:
            self._check_speed_control()

    @property
    def board_type(self) -> BoardType:
        """The board that base speaks with, and that the simulator runs."""
        return boards_chosen_in(BASE_BOARD.chosen_in)[self.board]

    @property
    def asks_for_speeds(self) -> bool:
        """Whether the base board is asked for speeds; else for levels."""
        return self.wheel_control == "speed"

    @property
    def unchecked(self) -> Trouble:
        """Why nobody knows yet whether the robot moves as it is asked."""
        if self.is_checked:
            return NO_TROUBLE
        return Trouble("the wiring is not checked", *CHECK_THEM)

    def require_countable(self, robot: RobotConfig) -> None:
        """Raise ValueError where the wheels may be faster than the board counts: nobody would see what is lost."""
        most = self.board_type.most_counts
        counts = robot.max_wheel_speed * max(robot.left_ticks_per_metre, robot.right_ticks_per_metre)
        if most and counts > most:
            raise ValueError(
                f"max_wheel_speed is {robot.max_wheel_speed:g} m/s, {counts:.0f} counts/s by ticks_per_metre: "
                f"the board {self.board} counts {most}; it must be {most / counts * robot.max_wheel_speed:.2f} at most"
            )

    def require_its_levels(self, robot: RobotConfig) -> None:
        """Raise ValueError where a level is a speed of the controller's own loop, and `max_level` another speed."""
        hz = self.board_type.loop_hz
        if hz and (level := round(robot.max_wheel_speed * robot.ticks_per_metre / hz)) != self.max_level:
            raise ValueError(
                f"max_level is {self.max_level}: the board {self.board} takes counts within 1/{hz} s, "
                f"and max_wheel_speed is {level} of them by ticks_per_metre; it must be {level}"
            )

    def board_settings(self, robot: RobotConfig, acceleration: float) -> ConfigureFrame:
        """Return what base tells the board of this robot.

        `acceleration`: m/s² by which a wheel that is asked for a speed may get faster.
        """
        by_levels_only = msgspec.structs.replace(
            by_levels(self.wiring, self.max_level, self.stall_level),
            left_counts_per_km=round(robot.left_ticks_per_metre * 1000),
            right_counts_per_km=round(robot.right_ticks_per_metre * 1000),
        )
        if not self.asks_for_speeds:
            return by_levels_only
        control = self.speed_control
        # Rounded up: what is rounded of a speed within the limit is within it, too.
        fastest = math.ceil(robot.max_wheel_speed * UM_PER_M)
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
