"""The table `[base.drive]` of a robot that balances on two wheels: its body, motors, gains and wiring."""

import math
from typing import Annotated, ClassVar, Final

from giraff_base.drives.balancer.response import run_on
from giraff_base.drives.balancer.stability import Gains, Loop, Mechanics, advice
from giraff_base.drives.wheel_wiring import WheelWiring
from giraff_core.bounds import Bounds, check_bounds
from giraff_core.robot import RobotConfig
from giraff_core.tuning import Tuning
from giraff_schemas.boards import BALANCER_BOARD, BoardType
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_schemas.wires.balancer import PROTOCOL_HASH, BalanceConfigureFrame

GRAVITY: Final = 9.81
"""m/s²."""
_GAIN: Final = Bounds(0.0, 10_000.0)
_CATCHES: Final = math.radians(14.0)
"""rad. Up to this lean the board tries to catch the robot; beyond it, it goes off."""
_TO_CATCH: Final = 2.0
"""Times the torque that just ends the growth of a fall there: as much again brings the body back."""
_RUN_ON: Final = 0.06
"""m. A halt may go on by so much on the linear body, where drawn robots went on by up to 0.11 m."""
_RUN_ON_STANDING: Final = 0.20
"""m. The same of one that only stands, from _HALTED. With 0.4 and more, drawn robots wandered for metres."""
_HALTED: Final = 0.4
"""m/s."""
_RADIUS_OFF: Final = 0.02
"""Largest share by which radius and counts may contradict `ticks_per_metre`."""
_SPEED_TO_CATCH: Final = 0.5
"""Share of the motors' speed without load that stays free, so that the wheels can get under the body."""


class BalancingBody(WheelWiring, frozen=True, kw_only=True):
    """The body, from which gains are computed."""

    body_mass: Annotated[float, Bounds(1.0, 200.0, "kg")]
    """kg of all that leans: chassis, batteries and mast."""
    centre_height: Annotated[float, Bounds(0.02, 2.0, "m")]
    """m from the axle up to the centre of mass of the body."""
    body_inertia: Annotated[float, Bounds(0.001, 200.0, "kg m²")]
    """kg m² of the body about its centre of mass, about an axis along the axle."""
    wheel_mass: Annotated[float, Bounds(0.01, 50.0, "kg")]
    wheel_inertia: Annotated[float, Bounds(0.0, 10.0, "kg m²")]
    """kg m² of a wheel about the axle."""
    rotor_inertia: Annotated[float, Bounds(0.0, 10.0, "kg m²")]
    """kg m² of a motor's rotor, as seen at the wheel: multiplied by the square of the gear ratio."""
    wheel_radius: Annotated[float, Bounds(0.01, 1.0, "m")]
    torque_max: Annotated[float, Bounds(0.1, 1000.0, "N m")]
    """N m. Largest torque of both motors. To catch itself it needs more than to stand: a low limit makes it fall."""

    @property
    def mechanics(self) -> Mechanics:
        """The body near upright. The rotors turn against it."""
        mass, height, radius, rotors = self.body_mass, self.centre_height, self.wheel_radius, 2 * self.rotor_inertia
        return Mechanics(
            rolling=mass + 2 * self.wheel_mass + (2 * self.wheel_inertia + rotors) / radius**2,
            coupling=mass * height - rotors / radius,
            tipping=self.body_inertia + mass * height**2 + rotors,
            gravity=self.gravity,
            wheel_radius=radius,
        )

    @property
    def gravity(self) -> float:
        """N m/rad. What gravity gains on the body for each rad that it leans."""
        return self.body_mass * GRAVITY * self.centre_height


class BalancerConfig(
    BalancingBody, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="type", tag="balancer"
):
    """Gains, motors, battery and wiring of a robot that balances. Torques are those at the wheels."""

    LIVE: ClassVar = Tuning.READ_ONLY
    BY_HAND: ClassVar[str] = "docs/build-a-balancer.md"

    k1: Annotated[float, Tuning.CHECKED, _GAIN]
    """N m/rad. Torque of both motors for each rad that it leans."""
    k2: Annotated[float, Tuning.CHECKED, _GAIN]
    """N m s/rad. Torque for each rad/s."""
    k3: Annotated[float, Tuning.CHECKED, _GAIN]
    """N m/m. Torque for each m that it is beyond its place. With k3 = k4 = 0 it goes by its lean alone and drifts."""
    k4: Annotated[float, Tuning.CHECKED, _GAIN]
    """N m s/m. Torque for each m/s that it is too fast."""
    counts_per_turn: Annotated[int, Bounds(16, 65_535)]
    """Encoder counts for each turn of a wheel."""
    motor_constant: Annotated[float, Bounds(0.001, 60.0, "V s/rad")]
    """V s/rad at the wheel, and N m for each A."""
    motor_resistance: Annotated[float, Bounds(0.01, 60.0, "ohm")]
    """ohm of a motor with its leads."""
    friction: Annotated[float, Bounds(0.0, 60.0, "N m")]
    """N m of dry friction of one motor with its gear, at the wheel."""
    acceleration: Annotated[float, Bounds(0.01, 5.0, "m/s²")] = 0.25
    """m/s² at which the board changes the speed that it holds."""
    braking: Annotated[float, Bounds(0.01, 0.5, "m/s²")] = 0.35
    """m/s² at which it slows down while it drives on. At 0.8 m/s² most robots fall."""
    battery_volts_per_count: Annotated[float, Bounds(0.001, 0.065, "V")]
    """V of the battery for each ADC count of the board."""
    battery_nominal: Annotated[float, Bounds(6.0, 60.0, "V")] = 12.0
    battery_minimum: Annotated[float, Bounds(5.0, 60.0, "V")] = 10.4
    """V. Below it the robot sits down."""
    driver_minimum: Annotated[float, Bounds(6.0, 30.0, "V")] = 10.0
    """V. Below it the motor driver cuts off, and the robot falls."""

    def __post_init__(self) -> None:
        check_bounds(self)
        if (self.k3 == 0.0) != (self.k4 == 0.0):
            raise ValueError(f"k3 is {self.k3:g} and k4 {self.k4:g}: either both are 0, or none is")
        gains = f"k1 {self.k1:g}, k2 {self.k2:g}, k3 {self.k3:g} and k4 {self.k4:g}"
        if not Loop(self.mechanics, self.gains).has_margin:
            raise ValueError(
                f"the robot falls with {gains}, with a quarter or 3.5 times as much, or with the play of its gears: "
                f"{advice(self.mechanics, self.gains) or '`giraff tune balance` computes others'}"
            )
        if (too_far := self._runs_on(_HALTED)) > _RUN_ON_STANDING:
            raise ValueError(
                f"with {gains} the robot runs on by {too_far:.2f} m before it stands, and wanders: "
                "`giraff tune balance` computes others"
            )
        if self.torque_max <= (least := _TO_CATCH * self.mechanics.turning_torque * _CATCHES):
            raise ValueError(
                f"torque_max is {self.torque_max:g} N m: it must be above {least:.1f}, or a push makes the robot fall"
            )
        if not self.driver_minimum < self.battery_minimum < self.battery_nominal:
            raise ValueError(
                f"driver_minimum is {self.driver_minimum:g} V, battery_minimum {self.battery_minimum:g} V and "
                f"battery_nominal {self.battery_nominal:g} V: they must rise, or the robot falls before it sits down"
            )

    @property
    def board_type(self) -> BoardType:
        """The board that base speaks with, and that the simulator runs."""
        return BALANCER_BOARD

    @property
    def unchecked(self) -> Trouble:
        """Why nobody knows yet whether the robot moves as it is asked."""
        if self.is_checked:
            return NO_TROUBLE
        return Trouble("the wiring is not checked", "write it into [base.drive]: docs/balancer.md")

    @property
    def gains(self) -> Gains:
        """The four gains."""
        return Gains(self.k1, self.k2, self.k3, self.k4)

    def drives(self, robot: RobotConfig) -> bool:
        """Return whether it may drive with its gains. Others hold it only while it stands."""
        return Loop(self.mechanics, self.gains).has_encoders and self._runs_on(robot.max_wheel_speed) <= _RUN_ON

    def _runs_on(self, speed: float) -> float:
        if not Loop(self.mechanics, self.gains).has_encoders:
            return 0.0
        return run_on(self.mechanics, self.gains, self.torque_max, speed, self.braking)

    def require_countable(self, robot: RobotConfig) -> None:
        """Raise ValueError where wheel and encoder contradict `ticks_per_metre`, or the motors `max_wheel_speed`."""
        counts = self.counts_per_turn / (math.tau * self.wheel_radius)
        if abs(counts / robot.ticks_per_metre - 1.0) > _RADIUS_OFF:
            raise ValueError(
                f"wheel_radius and counts_per_turn give {counts:.0f} counts per metre, "
                f"and ticks_per_metre is {robot.ticks_per_metre:.0f}: correct the wrong one"
            )
        no_load = self.battery_nominal / self.motor_constant * self.wheel_radius
        if robot.max_wheel_speed > no_load * (1.0 - _SPEED_TO_CATCH):
            raise ValueError(
                f"max_wheel_speed is {robot.max_wheel_speed:g} m/s: a motor without load makes {no_load:.2f} m/s, "
                f"and must have {_SPEED_TO_CATCH:.0%} of it left to catch the robot"
            )

    def board_settings(self, robot: RobotConfig) -> BalanceConfigureFrame:
        """Return what base tells the board of this robot. It names no boot and no session yet."""
        mass, height, radius = self.body_mass, self.centre_height, self.wheel_radius
        per_speed = (mass + 2 * self.wheel_mass) * radius + mass * height + 2 * self.wheel_inertia / radius
        per_rate = mass * height * (radius + height) + self.body_inertia
        return BalanceConfigureFrame(
            seq=0,
            boot_id=0,
            board_ms=0,
            protocol_hash=PROTOCOL_HASH,
            session=0,
            wiring=self.wiring,
            k1_mnm_rad=_thousandths(self.k1),
            k2_mnm_s_rad=_thousandths(self.k2),
            k3_mnm_m=_thousandths(self.k3),
            k4_mnm_s_m=_thousandths(self.k4),
            gravity_mnm_rad=_thousandths(self.gravity),
            momentum_gms=_thousandths(per_speed),
            momentum_gm2=_thousandths(per_rate),
            radius_um=round(radius * 1e6),
            track_um=round(robot.kinematics.track_width * 1e6),
            counts_per_turn=self.counts_per_turn,
            motor_mv_s=_thousandths(self.motor_constant),
            motor_mohm=_thousandths(self.motor_resistance),
            friction_mnm=_thousandths(self.friction),
            torque_max_mnm=_thousandths(self.torque_max),
            acceleration_mm_s2=_thousandths(self.acceleration),
            braking_mm_s2=_thousandths(self.braking),
            # Rounded up: no twist within the limits is beyond the board.
            speed_max_mm_s=math.ceil(robot.max_wheel_speed * 1000),
            turn_max_mrad_s=math.ceil(robot.max_angular_speed * 1000),
            battery_uv_count=round(self.battery_volts_per_count * 1e6),
            battery_min_mv=_thousandths(self.battery_minimum),
            driver_min_mv=_thousandths(self.driver_minimum),
        )


def _thousandths(value: float) -> int:
    return round(value * 1000)
