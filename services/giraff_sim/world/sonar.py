"""HC-SR04 ultrasonic sensors among the surfaces of a room. Metres and radians, but echo pulses in us.

What is known of the sensor: a cone of 15 degrees; 2 to 400 cm; stable up to 25-30 degrees between its axis
and a wall's normal, beyond that readings are far too long or missing; a pulse of 38 ms where nothing answers.
"""

import math
import random
from collections.abc import Mapping
from enum import StrEnum
from typing import Final, NamedTuple

import msgspec

from giraff_core.senses import Ultrasonic
from giraff_maps.room_file import Point
from giraff_schemas.wire import ECHO_US_PER_M
from giraff_sim.config import SimConfig
from giraff_sim.truth import EXACT, Truth
from giraff_sim.world.room import Hit, Pose, Room

SILENT_US: Final = 0.0  # for board_model.h: the echo line never rises
STUCK_US: Final = -1.0  # for board_model.h: it rises and stays
NO_ECHO_US: Final = 38_000.0
RANGE: Final = 4.0
SHORTEST: Final = 0.02
HALF_CONE: Final = math.radians(7.5)

_RAYS: Final = 9
_SURE: Final = math.cos(math.radians(25.0))  # of the incidence: heard for certain
_DOUBTFUL: Final = math.cos(math.radians(30.0))  # beyond: mostly not heard
_HEARD_SLANTED: Final = 0.2  # share of pings heard beyond that; sweeps recorded 0 to 0.42
_LOST_SLANTED: Final = 0.5  # share of the unheard ones that end in no echo; the others come by a detour
_DETOUR: Final = (1.3, 3.0)  # times the true range
_FOREIGN_PERIOD: Final = 10.3  # m, there and back in the 60 ms between two pings of the other robot
_FLOOR: Final = -1  # no surface of a room has this number


class Lean(NamedTuple):
    """How the body that carries the sensor leans."""

    angle: float
    """rad, forward positive."""
    pivot: float
    """m above the floor of the axle about which it leans."""


UPRIGHT: Final = Lean(0.0, 0.0)


class SonarFault(StrEnum):
    """What can be wrong with a sensor."""

    NONE = "none"
    DEAD = "dead"
    """The echo line never rises."""
    STUCK = "stuck"
    """The echo line rises and stays."""
    DEAF = "deaf"
    """It pings and nothing answers, as in the open: a membrane that is covered, or has come off."""
    OVERHEARS = "overhears"
    """It is deaf to its own pings, and takes those of another robot beside it for echoes."""
    FROZEN = "frozen"
    """Every ping measures what the last one before the fault did."""
    WILD = "wild"
    """Any range at all."""
    WILD_SOME = "wild_some"
    """Each ping is wild by the chance `wild_share`: half of those find nothing, half any range at all."""


class Sonar:
    """One sensor on the robot."""

    def __init__(
        self, mount: Ultrasonic, room: Room, sim: SimConfig, seed: str, noise: float = 0.0, scale: float = 1.0
    ) -> None:
        """`mount`: where it truly sits and looks; `noise`: m, standard deviation of a range; `scale`: m there for
        each metre of echo."""
        self.fault = SonarFault.NONE
        self.wild_share = 0.0
        """Of the pings, while WILD_SOME."""
        self.pings = 0
        self._mount = mount
        self._room = room
        self._noise = noise
        self._echo_us_per_m = ECHO_US_PER_M / scale
        self._crosstalk = sim.sonar_crosstalk
        self._random = random.Random(seed)
        self._wild = random.Random(f"{seed}/wild")
        self.must_have_heard: tuple[Pose, Hit | None, int] | None = None
        """Of the newest ping: where the robot was, what a sound sensor heard for certain, and the room's version; None
        of one that was not sound."""
        self.measured: float | None = None
        """m that the newest ping measured; None where nothing answered, or where the ping was not sound."""
        self.told: float | None = None
        """m that the newest ping tells, sound or not; None where it tells of no echo."""
        self._last_us = NO_ECHO_US
        overheard = random.Random(f"{seed}/overheard")
        self.overheard = overheard.uniform(0.0, _FOREIGN_PERIOD)
        """m at which it hears the other robot's ping next; nothing where that is beyond its range."""
        self.overheard_step = overheard.uniform(-0.5, 0.5) * overheard.choice((0.1, 1.0, _FOREIGN_PERIOD))
        """m from one of its pings to the next: the boards' clocks differ, or their cycles."""

    def echo_us(self, robot: Pose, lean: Lean = UPRIGHT) -> float:
        """Ping with the robot at `robot`: the echo pulse's length, or SILENT_US, or STUCK_US."""
        pulse_us = self._answer_us(robot, lean)
        self.told = pulse_us / ECHO_US_PER_M if 0.0 < pulse_us < NO_ECHO_US else None
        return pulse_us

    def _answer_us(self, robot: Pose, lean: Lean) -> float:
        self.pings += 1
        self.must_have_heard = self.measured = None
        match self.fault:
            case SonarFault.DEAD:
                return SILENT_US
            case SonarFault.STUCK:
                return STUCK_US
            case SonarFault.DEAF:
                return NO_ECHO_US
            case SonarFault.OVERHEARS:
                self.overheard = (self.overheard + self.overheard_step) % _FOREIGN_PERIOD
                return self._pulse_us(self.overheard if self.overheard <= RANGE else None)
            case SonarFault.WILD:
                return self._random.uniform(SHORTEST, RANGE) * ECHO_US_PER_M
            case SonarFault.WILD_SOME if self._wild.random() < self.wild_share:
                if self._wild.random() < 0.5:
                    return NO_ECHO_US
                return self._wild.uniform(SHORTEST, RANGE) * ECHO_US_PER_M
            case SonarFault.NONE | SonarFault.WILD_SOME:
                self._last_us = self._pulse_us(self._ping(robot, lean))
                self.measured = self._last_us / ECHO_US_PER_M if self._last_us < NO_ECHO_US else None
            case SonarFault.FROZEN:
                pass
        return self._last_us

    def heard(self, robot: Pose) -> float | None:
        """m to the nearest surface that this sensor, sound and without noise, hears for certain; None: there is none.

        One that is nearer and slanted may be heard too, by chance. Asking changes nothing.
        """
        echo = self.sure_echo(robot)
        return None if echo is None else echo.distance

    def sure_echo(self, robot: Pose) -> Hit | None:
        """The same with the surface that gives the echo."""
        origin = self.origin(robot)
        return self._surest(sorted(self.hits(origin)), origin.yaw)

    def echo_point(self, robot: Pose, echo: Hit) -> Point:
        """Where a surface gave this echo: of a wall's two points that far away, the one nearer to the sensor's axis."""
        origin = self.origin(robot)
        if echo.round:
            return self._room.nearest_of(echo.surface, origin.x, origin.y)

        def off_axis(point: Point) -> float:
            return abs(math.remainder(math.atan2(point[1] - origin.y, point[0] - origin.x) - origin.yaw, math.tau))

        return min(self._room.points_at(echo.surface, origin.x, origin.y, echo.distance), key=off_axis)

    def origin(self, robot: Pose, lean: Lean = UPRIGHT) -> Pose:
        """Where the sensor truly is, and looks, with the robot at `robot`."""
        cos, sin = math.cos(robot.yaw), math.sin(robot.yaw)
        mount = self._mount
        ahead = mount.x
        if lean.angle:
            ahead = mount.x * math.cos(lean.angle) + (mount.z - lean.pivot) * math.sin(lean.angle)
        x, y = robot.x + cos * ahead - sin * mount.y, robot.y + sin * ahead + cos * mount.y
        return Pose(x, y, robot.yaw + mount.yaw)

    def _surest(self, hits: list[Hit], axis: float) -> Hit | None:
        """The first of these, nearest first, that is heard for certain."""
        return next((hit for hit in hits if self._incidence(hit, axis) >= _SURE), None)

    def _ping(self, robot: Pose, lean: Lean) -> float | None:
        """The range one ping measures before noise, m; None when nothing answers."""
        origin = self.origin(robot, lean)
        hits = sorted(self.hits(origin))
        if self.fault is SonarFault.NONE:
            self.must_have_heard = robot, self._surest(hits, origin.yaw), self._room.version
        if lean.angle:
            hits = self._along_the_dip(robot, lean, hits)
        verdicts: dict[int, bool] = {_FLOOR: self._random.random() < _HEARD_SLANTED} if lean.angle else {}
        for hit in hits:
            if hit.round or hit.surface not in verdicts:
                verdicts[hit.surface] = self._is_heard(hit, origin.yaw)
            if verdicts[hit.surface]:
                return hit.distance
        if not hits or self._random.random() < _LOST_SLANTED:
            return None
        detour = hits[0].distance * self._random.uniform(*_DETOUR)
        return detour if detour <= RANGE else None

    def hits(self, origin: Pose) -> list[Hit]:
        """What the cone meets: along rays spread over it, and at each point in it that faces the sensor."""
        offsets = [HALF_CONE * (2.0 * k / (_RAYS - 1) - 1.0) for k in range(_RAYS)]
        for direction in self._room.facing(origin.x, origin.y):
            offset = math.remainder(direction - origin.yaw, math.tau)
            if abs(offset) <= HALF_CONE:
                offsets.append(offset)
        rays = (self._room.ray(origin.x, origin.y, origin.yaw + offset, RANGE) for offset in offsets)
        return [hit for hit in rays if hit is not None]

    def _along_the_dip(self, robot: Pose, lean: Lean, hits: list[Hit]) -> list[Hit]:
        """Return the hits as a sensor that dips meets them, and the floor, a slanted surface.

        What lies behind where it looks at the floor must not have been heard.
        """
        sin = math.sin(lean.angle) * math.cos(self._mount.yaw)
        cos = math.sqrt(1.0 - sin * sin)
        found = [hit._replace(distance=far) for hit in hits if (far := hit.distance / cos) <= RANGE]
        mount = self._mount
        height = lean.pivot + (mount.z - lean.pivot) * math.cos(lean.angle) - mount.x * math.sin(lean.angle)
        floor = max(0.0, height) / sin if sin > 0.0 else math.inf
        if self.must_have_heard is not None:
            # The judges ask the room from an upright robot.
            sure = self.sure_echo(robot)
            is_nearer = sure is not None and sure.distance < min(RANGE, floor) * cos
            self.must_have_heard = robot, sure if is_nearer else None, self._room.version
        if floor <= RANGE:
            found.append(Hit(distance=floor, surface=_FLOOR, incidence=sin, round=False))
        return sorted(found)

    def _is_heard(self, hit: Hit, axis: float) -> bool:
        incidence = self._incidence(hit, axis)
        if incidence >= _SURE:
            return True
        chance = _HEARD_SLANTED
        if incidence > _DOUBTFUL:
            chance += (1.0 - chance) * (incidence - _DOUBTFUL) / (_SURE - _DOUBTFUL)
        return self._random.random() < chance

    def _incidence(self, hit: Hit, axis: float) -> float:
        """Cosine: of the ray to a post, whose edge is slanted however it stands; of a wall, of the sensor's axis."""
        return hit.incidence if hit.round else self._room.incidence(hit.surface, axis)

    def _pulse_us(self, heard: float | None) -> float:
        if self._crosstalk and self._random.random() < self._crosstalk:
            heard = self._random.uniform(SHORTEST, heard or RANGE)
        if heard is None:
            return NO_ECHO_US
        noise = self._random.gauss(0.0, self._noise) if self._noise else 0.0
        return max(SHORTEST, heard + noise) * self._echo_us_per_m


def sonars(
    mounts: Mapping[str, Ultrasonic], room: Room, sim: SimConfig, seed: int, truth: Truth = EXACT
) -> dict[int, Sonar]:
    """The robot's sensors by their number on the ranger board; `mounts`: where they are believed to be."""
    made = {}
    for mount in mounts.values():
        number = mount.index
        true = msgspec.structs.replace(
            mount, x=mount.x + truth.sensor_xs[number], yaw=mount.yaw + truth.sensor_yaws[number]
        )
        scale = mount.scale * truth.sonar_scales[number]
        made[number] = Sonar(true, room, sim, f"{seed}/sonar/{number}", truth.sonar_noise, scale)
    return made
