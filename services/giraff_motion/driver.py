"""Brings the robot to the end of one piece of its way: a profile of speed, a stop in time, and a second try."""

import math
from typing import Final, NamedTuple

from giraff_core.kinematics.pose import Pose
from giraff_motion.legs import Leg, Limits
from giraff_schemas.messages import Direction, Odometry

_TRIES: Final = 4
_STUCK: Final = 0.005
"""m/s or rad/s. A robot that is asked to move and is no faster does not move."""
_FIRST_COAST: Final = 0.1
_MOST_COAST: Final = 0.5
"""s"""
_LOOKS: Final = 0.05
"""s, at most, from one command to the next."""
_STIFF: Final = 0.5
"""s: a robot that stands although it is asked to move is asked for more by its least speed in so long."""

STANDS: Final = (0.0, 0.0)


class Rest(NamedTuple):
    """The speeds that odometry may have of a robot that stands."""

    speed: float
    """m/s"""
    turn_speed: float
    """rad/s"""
    time: float
    """s. The robot has stood for so long before its place is judged."""

    def holds(self, odometry: Odometry) -> bool:
        """Return whether the robot stands."""
        return abs(odometry.linear_x) <= self.speed and abs(odometry.angular_z) <= self.turn_speed


class Coast:
    """How far the robot goes on after it was told to stop, learned from each stop: s, by the speed that it had."""

    def __init__(self) -> None:
        self.seconds = _FIRST_COAST

    def learn(self, way: float, speed: float) -> None:
        """It went on by `way` (m or rad) after it had `speed`."""
        if speed > 0.0:
            self.seconds += (max(0.0, min(_MOST_COAST, way / speed)) - self.seconds) / 2.0


class Driver:
    """Along one leg. Times are s of any one monotonic clock."""

    def __init__(self, leg: Leg, limits: Limits, rest: Rest, coast: Coast, pose: Pose) -> None:
        self._leg = leg
        self._limits, self._rest = limits, rest
        self._coast = coast
        self._tries = 0
        self._least = limits.least
        self.is_done = abs(leg.error(pose)) <= limits.tolerance
        """The robot rests at its end, or as near to it as some tries have brought it."""
        self.is_stopping = False
        """It is told to stand, and has not come to rest."""
        self._begin(pose)

    @property
    def direction(self) -> Direction:
        """That it drives in now, for the guard."""
        return self._leg.direction(self._sign)

    @property
    def is_stuck(self) -> bool:
        """Whether the robot stands although it is asked to move."""
        return self._stuck_since is not None

    def twist(self, pose: Pose, odometry: Odometry, now: float) -> tuple[float, float]:
        """m/s and rad/s to ask for now."""
        speed = abs(odometry.angular_z if self._leg.turns else odometry.linear_x)
        remaining = self._leg.error(pose) * self._sign
        if not self.is_stopping:
            if remaining > self._coast.seconds * speed:
                return self._leg.twist(pose, self._sign * self._speed(remaining, speed, now))
            self.is_stopping, self._at_stop, self._moved = True, (remaining, speed), now
        self._settle(pose, remaining, odometry, now)
        return STANDS

    def _begin(self, pose: Pose) -> None:
        self._sign = math.copysign(1.0, self._leg.error(pose))
        self._tries += 1
        self.is_stopping = False
        self._at_stop = (0.0, 0.0)
        self._moved = 0.0
        """When it was last seen to move while it stopped."""
        self._stuck_since: float | None = None

    def _speed(self, remaining: float, speed: float, now: float) -> float:
        """√(2·a·d), within its limits."""
        limits = self._limits
        if speed > _STUCK:
            self._stuck_since = None
        elif self._stuck_since is None:
            self._stuck_since = now
        else:
            asked_for = min(_LOOKS, now - self._stuck_since)  # while its way is blocked it asks for nothing
            self._least = min(limits.top, self._least + limits.least * asked_for / _STIFF)
            self._stuck_since = now
        to_go = max(0.0, remaining - self._coast.seconds * speed)
        return min(limits.top, max(self._least, math.sqrt(2.0 * limits.deceleration * to_go)))

    def _settle(self, pose: Pose, remaining: float, odometry: Odometry, now: float) -> None:
        if not self._rest.holds(odometry):
            self._moved = now
        if now - self._moved < self._rest.time:
            return
        before, speed = self._at_stop
        self._coast.learn(before - remaining, speed)
        if abs(remaining) <= self._limits.tolerance or self._tries >= _TRIES:
            self.is_done = True
        else:
            self._begin(pose)
