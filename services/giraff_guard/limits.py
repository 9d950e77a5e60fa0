"""How fast the robot may go towards something, and the verdicts that say so."""

from typing import Final, Literal

from giraff_core.live import Live
from giraff_core.robot import RobotConfig
from giraff_guard.config import GuardConfig
from giraff_guard.stopping import fastest, stopping_distance
from giraff_schemas.messages import Clearance, DirectionLimit
from giraff_schemas.trouble import NO_TROUBLE, Trouble

DriveDirection = Literal["forward", "backward"]

SIGN: Final[dict[DriveDirection, float]] = {"forward": 1.0, "backward": -1.0}
OTHER: Final[dict[DriveDirection, DriveDirection]] = {"forward": "backward", "backward": "forward"}
_UNMEASURED: Final = 0.5
"""m/s² that a robot of unknown deceleration is taken to brake with from creeping."""


class Limits:
    """The limits of one robot."""

    def __init__(self, live: Live[GuardConfig], robot: RobotConfig) -> None:
        self._live = live
        self._robot = robot

    @property
    def config(self) -> GuardConfig:
        """The configuration in force."""
        return self._live.config

    @property
    def most(self) -> float:
        """m/s."""
        return self._robot.max_wheel_speed

    @property
    def footprint_radius(self) -> float:
        """m."""
        return self._robot.footprint_radius

    @property
    def swept_radius(self) -> float:
        """m from the robot's middle, within which a place that a sensor has seen is in its way."""
        return self._robot.footprint_radius + self.config.memory_margin

    def fastest(self, room: float, old: float = 0.0) -> float:
        """m/s from which the robot stops within `room` m, by what is `old` s old."""
        config = self.config
        return fastest(room, config.reaction_time + old, config.deceleration or _UNMEASURED, config.run_on)

    def stops_within(self, speed: float) -> float:
        """m that it takes to stop from `speed` (m/s)."""
        config = self.config
        return stopping_distance(speed, config.reaction_time, config.deceleration or _UNMEASURED, config.run_on)

    def block(self, sensor: str, reason: Trouble) -> DirectionLimit:
        """Nothing passes."""
        return DirectionLimit(allowed=0.0, clearance="blocked", sensor=sensor, reason=reason)

    def creep(self, sensor: str, reason: Trouble) -> DirectionLimit:
        """As slowly as where nobody looks."""
        return self.allow(self.config.creep_linear, sensor, reason)

    def allow(self, allowed: float, sensor: str = "", reason: Trouble = NO_TROUBLE) -> DirectionLimit:
        """Up to `allowed` m/s; what the robot cannot do anyway is free."""
        if allowed >= self.most:
            return DirectionLimit(allowed=self.most, clearance="free", sensor="")
        clearance: Clearance = "creep" if allowed <= self.config.creep_linear else "slow"
        return DirectionLimit(allowed=allowed, clearance=clearance, sensor=sensor, reason=reason)
