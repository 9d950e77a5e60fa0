"""How the base board drives the wheels: by PWM levels, or by speeds that its own loops hold."""

from __future__ import annotations

from typing import Annotated, Final, Literal

import msgspec

from giraff_core.bounds import Bounds, check_bounds
from giraff_schemas.wire import PROTOCOL_HASH, ConfigureFrame, Wiring

WheelControl = Literal["level", "speed"]
"""`level`: open loop, a level stands for a speed. `speed`: the board's loops hold what is asked."""

_GAIN: Final = Bounds(0.0, 3900.0)  # 16 bits of the board's fixed point
UM_PER_M: Final = 1e6
"""The board counts in whole micrometres."""


class SpeedControl(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The table `[robot.speed_control]`: the base board's two wheel loops and the turn loop that couples them.

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
