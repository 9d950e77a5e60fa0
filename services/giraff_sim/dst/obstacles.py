"""Whether the robot is driven towards what it has heard."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Mapping
from typing import Final

from giraff_node.robot import SensorPose
from giraff_schemas.wire import RANGE_SENSORS, RANGE_SLOT_MS
from giraff_sim.closed_loop import Settings
from giraff_sim.dst.explain import Twist
from giraff_sim.dst.ledger import Heard
from giraff_sim.room import Pose
from giraff_sim.sonar import HALF_CONE
from giraff_sim.world import World

_REACTION_US: Final = 70_000  # from the first short reading at the guard to a zero frame: 60 ms, and a report's period
_TWO_CYCLES_US: Final = 2 * RANGE_SENSORS * RANGE_SLOT_MS * 1000
_SURE: Final = math.cos(math.radians(25.0))  # of the incidence
_SAME: Final = 0.10  # m between a reading and the surface it is of
_RAYS: Final = 9
_A_LITTLE: Final = 0.01  # m


class Obstacles:
    """Looks at the world for what readings only tell."""

    def __init__(self, world: World, settings: Settings) -> None:
        self._world = world
        self._robot = settings.robot
        self._deceleration = settings.guard.deceleration or math.inf
        self._poses: deque[tuple[int, Pose]] = deque(maxlen=200)

    def note(self, now_us: int) -> None:
        """Remember where the robot is."""
        self._poses.append((now_us, self._world.plant.pose))

    def touched(self, readings: Mapping[str, deque[Heard]]) -> str:
        """Where the body touches, and what the sensors told last."""
        plant = self._world.plant
        _, normal_x, normal_y = self._world.room.nearest(plant.pose.x, plant.pose.y)
        bearing = math.degrees(math.remainder(math.atan2(-normal_y, -normal_x) - plant.pose.yaw, math.tau))
        speed = (plant.left.speed + plant.right.speed) / 2.0
        told = (
            f"{name} {heard[-1].reading.range:.2f} m" if heard[-1].reading.range is not None else f"{name} nothing"
            for name, heard in sorted(readings.items())
            if heard
        )
        return f"{bearing:+.0f} degrees from ahead, at {speed:+.2f} m/s; {', '.join(told)}"

    def ahead(self, twist: Twist, readings: Mapping[str, deque[Heard]], now_us: int) -> str:
        """What this frame drives at; empty when nothing that echoed in the last two cycles is too near."""
        if not twist.goes:
            return ""
        stopping = twist.linear * twist.linear / (2.0 * self._deceleration)
        for name, pose in self._robot.sensors.items():
            if (abs(pose.yaw) < 1.0) != (twist.linear > 0.0):
                continue
            for heard in readings[name]:
                told = heard.reading.range
                if told is None or told > stopping + self._robot.footprint_radius + _SAME:
                    continue
                if now_us - heard.at_us < _REACTION_US or now_us - heard.born_us > _TWO_CYCLES_US:
                    continue
                for surface in self._surfaces(pose, heard):
                    clearance = self._clearance(surface)
                    nearer = self._clearance(surface, math.copysign(_A_LITTLE, twist.linear)) < clearance
                    if nearer and clearance < stopping:
                        return (
                            f"{twist.linear:.2f} m/s towards what {name} heard at {told:.2f} m "
                            f"{(now_us - heard.at_us) / 1e6:.3f} s ago, now {clearance:.2f} m from the body"
                        )
        return ""

    def _surfaces(self, mount: SensorPose, heard: Heard) -> set[int]:
        """Those that were, and are, where the reading tells, facing the sensor."""
        then = next((pose for at_us, pose in self._poses if at_us >= heard.born_us), self._world.plant.pose)
        cos, sin = math.cos(then.yaw), math.sin(then.yaw)
        x, y = then.x + cos * mount.x - sin * mount.y, then.y + sin * mount.x + cos * mount.y
        axis = then.yaw + mount.yaw
        room = self._world.room
        found = set()
        for ray in range(_RAYS):
            hit = room.ray(x, y, axis + HALF_CONE * (2.0 * ray / (_RAYS - 1) - 1.0), 4.0)
            if hit is None or abs(hit.distance - (heard.reading.range or 0.0)) > _SAME:
                continue
            # A post's edge is slanted, however it stands: a ray that grazes it mostly does not come back.
            if (hit.incidence if hit.round else room.incidence(hit.surface, axis)) >= _SURE:
                found.add(hit.surface)
        return found

    def _clearance(self, surface: int, step: float = 0.0) -> float:
        """m between the body and a surface, now or after `step` m ahead."""
        x, y, yaw = self._world.plant.pose
        distance = self._world.room.distance(surface, x + step * math.cos(yaw), y + step * math.sin(yaw))
        return distance - self._robot.footprint_radius
