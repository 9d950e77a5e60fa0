"""Where something may touch a sensor: it was heard right before it, and no sensor can tell it from having gone."""

from __future__ import annotations

import math
from typing import Final

from giraff_sim.closed_loop import Settings
from giraff_sim.room import Pose
from giraff_sim.world import World

_ODOMETRY: Final = 1.1  # a guard knows by its wheels how far the robot is from there: times the true way, at most


class Touching:
    """Holds the guard to no free way until the robot has moved or turned away, by the truth. Asked in each step."""

    def __init__(self, world: World, settings: Settings) -> None:
        self._world = world
        self._sensors = settings.robot.sensors
        self._near = settings.guard.near
        self._clear = _ODOMETRY * 2.0 * settings.guard.near
        self._turned = _ODOMETRY * 4.0 * settings.guard.half_cone
        self._heard_before = {index: sonar.pings for index, sonar in world.sonars.items()}
        self._near_by: dict[str, tuple[Pose, float]] = {}
        """By sensor: where the robot was when it last heard something so near, and how near, m."""

    def note(self) -> None:
        """Take the pings of this step, and where the robot is."""
        pose = self._world.plant.pose
        for name, mount in self._sensors.items():
            sonar = self._world.sonars[mount.index]
            if sonar.pings != self._heard_before[mount.index]:
                self._heard_before[mount.index] = sonar.pings
                if sonar.measured is not None and sonar.measured < self._near:
                    self._near_by[name] = pose, sonar.measured
            if name in self._near_by and self._is_away(mount.yaw, pose, *self._near_by[name]):
                del self._near_by[name]

    def is_possible(self, way: float) -> bool:
        """Whether something may touch a sensor that looks along `way`: 1 forward, -1 backward."""
        return any((abs(self._sensors[name].yaw) < 1.0) == (way > 0.0) for name in self._near_by)

    def _is_away(self, axis: float, pose: Pose, then: Pose, distance: float) -> bool:
        direction = then.yaw + axis
        nearer = (pose.x - then.x) * math.cos(direction) + (pose.y - then.y) * math.sin(direction)
        turned = abs(math.remainder(pose.yaw - then.yaw, math.tau))
        return distance - nearer >= self._clear or turned >= self._turned
