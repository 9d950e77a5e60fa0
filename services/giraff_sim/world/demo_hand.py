"""The demonstration's hand: a person who sees the robot and steers it round the room."""

import math
import random
from enum import Enum, auto
from typing import Final

from giraff_sim.world.bno055 import GRAVITY, Vector
from giraff_sim.world.room import Pose


class _Mood(Enum):
    DRIVING = auto()
    RESTING = auto()
    """Flat for a moment: before setting off, and when the robot does not move as asked."""
    BACKING = auto()
    TURNING = auto()
    """Away from what is in the way."""


_REACHED: Final = 0.35  # m from a waypoint at which the next one is meant
_FORWARD: Final = math.radians(31.0)
_FORWARD_LEAST: Final = math.radians(14.0)  # beyond every curve's dead zone
_SIDEWAYS: Final = math.radians(24.0)
_SIDEWAYS_LEAST: Final = math.radians(9.0)
_BACKWARD: Final = math.radians(-16.0)
_STRAIGHT: Final = math.radians(4.0)  # heading error that a person lets pass
_TURN_ON_THE_SPOT: Final = math.radians(60.0)
_SLOW_DOWN: Final = 0.8  # m before a waypoint, down to half
_REST: Final = 1.2  # s
_BACK: Final = 1.6  # s
_TURN: Final = 1.6  # s
_PATIENCE: Final = 2.0  # s of asking in vain
_MOVED: Final = 0.05  # m, or as many radians, that count as getting on
_MUSCLE: Final = 0.22  # s, time constant of the wrist
_SWAY_HZ: Final = (1.0, 6.0)
_SWAY: Final = math.radians(0.25)
_RESTS_BEFORE_BACKING: Final = 2


class DemoHand:
    """A person who sees the robot and steers it from waypoint to waypoint.

    Rests a moment first, which is what arms a robot. When the robot does not get on, rests and tries again,
    then backs off, turns away and goes for the next waypoint.
    """

    trembles = True

    def __init__(self, waypoints: list[tuple[float, float]], seed: int, begin: float = 0.0) -> None:
        """`begin`: simulated s at which the hand takes the joystick."""
        if not waypoints:
            raise ValueError("the demonstration's hand needs a room with waypoints")
        self._waypoints = waypoints
        self._random = random.Random(f"{seed}/hand")
        self._waves = [(self._random.uniform(*_SWAY_HZ), self._random.uniform(0.0, math.tau)) for _ in range(4)]
        self._vigour = 1.0
        self._target = 0
        self._mood = _Mood.RESTING
        self._until = begin + _REST
        self._side = 1.0
        self._rests = 0
        self._forward = self._left = 0.0  # radians of tilt
        self._time = begin
        self._seen: tuple[float, Pose] | None = None

    def acceleration(self, seconds: float, robot: Pose) -> Vector:
        passed, self._time = max(0.0, seconds - self._time), seconds
        self._decide(seconds, robot)
        forward, left = self._intended(robot)
        share = 1.0 - math.exp(-passed / _MUSCLE)
        self._forward += (forward - self._forward) * share
        self._left += (left - self._left) * share
        sway = [_SWAY * math.sin(math.tau * rate * seconds + phase) for rate, phase in self._waves]
        x = GRAVITY * math.sin(self._forward + sway[0] + sway[1])
        y = GRAVITY * math.sin(self._left + sway[2] + sway[3]) * math.cos(self._forward)
        return x, y, math.sqrt(max(0.0, GRAVITY**2 - x * x - y * y))

    def _decide(self, seconds: float, robot: Pose) -> None:
        if self._mood is _Mood.DRIVING:
            target_x, target_y = self._waypoints[self._target]
            if math.hypot(target_x - robot.x, target_y - robot.y) < _REACHED:
                self._next_waypoint()
                self._rests = 0
            elif self._is_stuck(seconds, robot):
                self._give_up(seconds)
        elif seconds >= self._until:
            if self._mood is _Mood.BACKING:
                self._mood, self._until = _Mood.TURNING, seconds + _TURN
            else:
                self._mood = _Mood.DRIVING
                self._seen = None

    def _is_stuck(self, seconds: float, robot: Pose) -> bool:
        if self._seen is None:
            self._seen = (seconds, robot)
        since, before = self._seen
        moved = math.hypot(robot.x - before.x, robot.y - before.y)
        if moved > _MOVED or abs(math.remainder(robot.yaw - before.yaw, math.tau)) > _MOVED:
            self._seen = (seconds, robot)
            self._rests = 0 if moved > _MOVED else self._rests
            return False
        return seconds - since > _PATIENCE

    def _give_up(self, seconds: float) -> None:
        if self._rests < _RESTS_BEFORE_BACKING:
            self._rests += 1
            self._mood, self._until = _Mood.RESTING, seconds + _REST
            return
        self._rests = 0
        self._side = self._random.choice((-1.0, 1.0))
        self._next_waypoint()
        self._mood, self._until = _Mood.BACKING, seconds + _BACK

    def _next_waypoint(self) -> None:
        self._target = (self._target + 1) % len(self._waypoints)
        self._vigour = self._random.uniform(0.8, 1.0)
        self._seen = None

    def _intended(self, robot: Pose) -> tuple[float, float]:
        """Tilt forward and to the left, radians."""
        match self._mood:
            case _Mood.RESTING:
                return 0.0, 0.0
            case _Mood.BACKING:
                return _BACKWARD, 0.0
            case _Mood.TURNING:
                return 0.0, self._side * _SIDEWAYS
            case _Mood.DRIVING:
                return self._steered(robot)

    def _steered(self, robot: Pose) -> tuple[float, float]:
        target_x, target_y = self._waypoints[self._target]
        away_x, away_y = target_x - robot.x, target_y - robot.y
        error = math.remainder(math.atan2(away_y, away_x) - robot.yaw, math.tau)
        left = 0.0
        if abs(error) > _STRAIGHT:
            left = math.copysign(min(_SIDEWAYS, _SIDEWAYS_LEAST + 0.5 * abs(error)), error)
        if abs(error) > _TURN_ON_THE_SPOT:
            return 0.0, left
        near = min(1.0, 0.5 + 0.5 * math.hypot(away_x, away_y) / _SLOW_DOWN)
        forward = _FORWARD * self._vigour * (1.0 - abs(error) / _TURN_ON_THE_SPOT) * near
        return max(_FORWARD_LEAST, forward), left
