"""Judges a robot that balances: by its true way, and by nothing that its board says."""

from typing import Final, NamedTuple

from giraff_core.robot import RobotConfig
from giraff_schemas.wire import Frame
from giraff_schemas.wires.balancer import BalanceDriveFrame
from giraff_sim.bodies.balancer.body import BalancerBody
from giraff_sim.world.body import BoundedMotion, Demand

_RUNS_ON: Final = 0.12  # m: to brake, the axle first runs under the body
_TWICE_BRAKING: Final = 0.7  # m/s²
_ROUNDING: Final = 2e-6  # m/s, rad/s
_ROLLS_BACK: Final = 0.12  # m/s: a robot that stops or stands is not driven by less


class _Stop(NamedTuple):
    way: float
    """m where it began."""
    bound: float
    """m that it may go."""


class BalancerJudge:
    """Implements `giraff_sim.world.body.BodyJudge`."""

    def __init__(self, body: BalancerBody, robot: RobotConfig, outlives_us: int) -> None:
        """`outlives_us`: for so long a frame may have effect."""
        self._body, self._outlives_us = body, outlives_us
        self._late = outlives_us * 1e-6 * robot.max_wheel_speed  # m before the stop begins
        self._most = robot.max_wheel_speed, robot.max_angular_speed
        self._asked_us: int | None = None  # when it was asked to move last; None: it must stop, or stands
        self._stop: _Stop | None = None
        self._asks_too_much = ""

    def asked(self, frame: Frame, now_us: int) -> Demand | None:
        if not isinstance(frame, BalanceDriveFrame):
            return None
        linear, angular = frame.linear_um_s * 1e-6, frame.angular_urad_s * 1e-6
        demand = Demand(
            text=f"{linear:+.3f} m/s, {angular:+.3f} rad/s",
            boot_id=frame.boot_id,
            is_nothing=linear == angular == 0.0,
            linear=linear,
            angular=angular,
            linear_off=_ROUNDING,
            angular_off=_ROUNDING,
        )
        too_much = abs(linear) > self._most[0] + _ROUNDING or abs(angular) > self._most[1] + _ROUNDING
        self._asks_too_much = f"{demand.text} is beyond this robot" if too_much else ""
        if not demand.is_nothing:
            self._asked_us, self._stop = now_us, None
        elif self._asked_us is not None:
            self._begin_stop()
        return demand

    def note(self, now_us: int) -> None:
        if self._asked_us is not None and now_us - self._asked_us > self._outlives_us:
            self._begin_stop()
        loads = self._body.plant.loads
        if loads.force or loads.spring is not None or not self._body.is_powered:
            self._stop = None  # somebody moves it, or nothing does

    def wrong(self, now_us: int) -> str:  # noqa: ARG002  # the way does not go by time
        if self._stop is not None:
            gone = abs(self._body.plant.way - self._stop.way)
            if gone > self._stop.bound:
                return f"it went {gone:.2f} m after its stop, where {self._stop.bound:.2f} m is the most"
        return self._asks_too_much

    def goes(self, way: BoundedMotion) -> bool:
        speed = self._body.plant.speed
        return {
            "any": True,
            "travel": abs(speed) > _ROLLS_BACK,
            "forward": speed > _ROLLS_BACK,
            "backward": speed < -_ROLLS_BACK,
        }[way]

    def _begin_stop(self) -> None:
        plant = self._body.plant
        self._asked_us = None
        self._stop = _Stop(plant.way, plant.speed**2 / _TWICE_BRAKING + _RUNS_ON + self._late)
