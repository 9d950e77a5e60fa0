"""Whether a robot that may move, and is asked to where it is free, moves: the guard is no trap."""

import math
from typing import TYPE_CHECKING, Final

from giraff_core.senses import Ultrasonic
from giraff_sim.dst.judging.lost_near_sensor import LostNearSensor
from giraff_sim.dst.judging.sensors import looks_along
from giraff_sim.settings import Settings
from giraff_sim.world.world import World

if TYPE_CHECKING:
    from giraff_schemas.messages import BaseState
    from giraff_sim.dst.judging.ledger import Passed

_PATIENCE_US: Final = 1_000_000
_LOOK_US: Final = 20_000
_FRESH_US: Final = 250_000  # of the wish
_HEARD_US: Final = 400_000  # of the ranges
_WISH: Final = 0.15  # m/s asked for
_STRAIGHT: Final = 0.3  # rad/s asked for
_AHEAD: Final = 1.0  # m free of the body
_ASIDE: Final = 0.15  # m free beside and behind it
_FAN: Final = math.radians(50.0)
_RAYS: Final = 101  # two are 2 cm apart where the body would end: nothing that echoes lies between them


class ClearanceCheck:
    """Asked while the motors stand still, and told each step."""

    def __init__(self, world: World, settings: Settings) -> None:
        self._world = world
        self._robot, self._sensors = settings.robot, settings.robot.of(Ultrasonic)
        self._patience_us = _PATIENCE_US + world.body.settles_us
        self._lost_near_sensor = LostNearSensor(world, settings)
        self._refused_us: int | None = None
        self._looked_us = 0
        self._disturbances = 0
        self._calm_us = 0

    def note(self, now_us: int) -> None:
        """Take what this step has brought."""
        self._lost_near_sensor.note(now_us)

    def disturb(self) -> None:
        """A fault begins: nothing is sure to be proven."""
        self._disturbances += 1

    def calm(self, from_us: int) -> None:
        """One ends, and what it has left behind is proven again from then on."""
        self._disturbances -= 1
        self._calm_us = max(self._calm_us, from_us)

    def is_calm(self, now_us: int) -> bool:
        return not self._disturbances and now_us >= self._calm_us

    def moved(self, now_us: int) -> None:
        """A motor has power."""
        self._refused_us = None
        self._looked_us = now_us

    def refused(self, passed: "Passed | None", state: "BaseState | None", now_us: int) -> str:
        """What is refused, once it is for too long. `passed`: the newest that base was handed."""
        if now_us - self._looked_us < _LOOK_US:
            return ""
        self._looked_us = now_us
        if passed is None or state is None or not self._is_due(passed, state, now_us):
            self._refused_us = None
            return ""
        if self._refused_us is None:
            self._refused_us = now_us
        if now_us - self._refused_us <= self._patience_us:
            return ""
        self._refused_us = None
        return f"armed, and asked to where it is free, but still for {self._patience_us / 1e6:g} s: {state.reason}"

    def _is_due(self, passed: "Passed", state: "BaseState", now_us: int) -> bool:
        given = passed.given
        if not state.armed or given is None or not self.is_calm(now_us) or now_us - given.born_us > _FRESH_US:
            return False
        command = given.command
        if abs(command.linear_x) < _WISH or abs(command.angular_z) > _STRAIGHT or not command.lease_counter:
            return False
        if given.command.instance != passed.command.operator:
            return False
        way = math.copysign(1.0, command.linear_x)
        return (
            self._is_proven(passed, way, now_us) and not self._lost_near_sensor.is_possible(way) and self._is_free(way)
        )

    def _is_proven(self, passed: "Passed", way: float, now_us: int) -> bool:
        for name, pose in self._sensors.items():
            if looks_along(pose, way):
                heard = passed.ranges.get(name)
                if heard is None or heard[0].state != "echo" or now_us - heard[1] > _HEARD_US:
                    return False
        return True

    def _is_free(self, way: float) -> bool:
        room, pose, radius = self._world.room, self._world.plant.pose, self._robot.footprint_radius
        if self._world.plant.clearance < _ASIDE:
            return False
        middle = pose.yaw if way > 0.0 else pose.yaw + math.pi
        reach = radius + _AHEAD
        directions = (middle + _FAN * (2.0 * ray / (_RAYS - 1) - 1.0) for ray in range(_RAYS))
        return all(room.ray(pose.x, pose.y, direction, reach) is None for direction in directions)
