"""Where something may touch a sensor: it was heard right before it and is lost, and no sensor tells whether it went."""

import math
from collections import deque
from typing import Final, NamedTuple

from giraff_core.senses import Ultrasonic
from giraff_sim.dst.judging.sensors import NewPings, looks_along
from giraff_sim.settings import Settings
from giraff_sim.world.room import Pose
from giraff_sim.world.world import World

# The guard's bounds, a tenth wider: it measures distance, motion and turns with a small error.
_EARLIER: Final = 0.9
_LATER: Final = 1.1
_RESOLUTION: Final = 0.005  # m, of a reading


class _Ping(NamedTuple):
    at_us: int
    pose: Pose
    told: float | None
    """m to what answered, be it wild; None where nothing did."""


class _Lost(NamedTuple):
    pose: Pose
    distance: float


class LostNearSensor:
    """Knows what each sensor has lost so near, until the robot has moved or turned away from there.

    Pings and poses are the world's. The guard's numbers are the robot file's: no fault sets another `touch_distance`.
    """

    def __init__(self, world: World, settings: Settings) -> None:
        self._world = world
        self._guard = settings.guard
        self._sensors = settings.robot.of(Ultrasonic)
        self._new = NewPings(world, settings.robot)
        self._pings: dict[str, deque[_Ping]] = {name: deque(maxlen=3) for name in self._sensors}
        self._lost: dict[str, _Lost] = {}
        """By sensor: where the robot was when it last heard something so near, and how near, m."""

    def note(self, now_us: int) -> None:
        """Take the pings of this step, and where the robot is."""
        pose = self._world.plant.pose
        for name, sonar in self._new.pop_new():
            self._pings[name].append(_Ping(now_us, pose, sonar.told))
            self._judge(name, self._sensors[name].yaw)
        for name, lost in list(self._lost.items()):
            if self._is_away(name, lost, pose):
                del self._lost[name]

    def is_possible(self, way: float) -> bool:
        """Whether something may touch a sensor that looks along `way`: 1 forward, -1 backward."""
        return any(looks_along(self._sensors[name], way) for name in self._lost)

    def _judge(self, name: str, axis: float) -> None:
        """At the newest ping: two that agree, the later one near, and then one from farther away or none."""
        if len(self._pings[name]) < 3:
            return
        before, last, newest = self._pings[name]
        if newest.told is not None and newest.told < self._guard.touch_distance:
            self._lost.pop(name, None)  # it is there again
        if before.told is None or last.told is None or last.told > self._guard.touch_distance + _RESOLUTION:
            return
        turned = before.told * abs(math.remainder(last.pose.yaw - before.pose.yaw, math.tau))
        if abs(_farther(before, last, axis)) > _LATER * self._guard.range_tolerance + turned:
            return
        walked = self._guard.person_speed * (newest.at_us - last.at_us) * 1e-6
        if _farther(last, newest, axis) > _EARLIER * (self._guard.range_tolerance + walked):
            self._lost[name] = _Lost(last.pose, last.told)

    def _is_away(self, name: str, lost: _Lost, pose: Pose) -> bool:
        away = lost.distance - _nearer(lost.pose, pose, self._sensors[name].yaw)
        half_cone = self._guard.half_cone or self._sensors[name].half_cone
        turned = abs(math.remainder(pose.yaw - lost.pose.yaw, math.tau))
        return away >= _LATER * 2.0 * self._guard.touch_distance or turned >= _LATER * 4.0 * half_cone


def _nearer(then: Pose, now: Pose, axis: float) -> float:
    """m that the robot has come nearer along a sensor's axis as it was `then`."""
    direction = then.yaw + axis
    return (now.x - then.x) * math.cos(direction) + (now.y - then.y) * math.sin(direction)


def _farther(one: _Ping, other: _Ping, axis: float) -> float:
    """m by which what `other` tells is farther away than what `one` told; infinite where it tells nothing."""
    if one.told is None or other.told is None:
        return math.inf
    return other.told - (one.told - _nearer(one.pose, other.pose, axis))
