"""Whether the robot is driven towards what a sound sensor, on its true axis, has truly heard, and how fast it touches
what one has heard that is deaf now.

Nothing here is what a sensor, the ranger or the guard says: each ping is asked of the room, from where the robot truly
was. Only that a reading was handed to a guard, and when, is taken from the ledger.
"""

import math
from collections import defaultdict, deque
from collections.abc import Mapping
from typing import Final

from giraff_core.senses import Ultrasonic
from giraff_schemas.wire import RANGE_SENSORS, RANGE_SLOT_MS
from giraff_sim.dst.judging.ledger import Heard
from giraff_sim.dst.judging.sensors import NewPings, looks_along
from giraff_sim.settings import Settings
from giraff_sim.world.room import Hit, Pose
from giraff_sim.world.sonar import Sonar, SonarFault
from giraff_sim.world.world import World

REST: Final = 0.20
"""m that are left of the guard's margin before a wall, whatever the robot's truth is."""

_REACTION_US: Final = 50_000  # from the first short reading at the guard to a zero frame: 40 ms, and a report's period
_TWO_CYCLES_US: Final = 2 * RANGE_SENSORS * RANGE_SLOT_MS * 1000
_SAME_US: Final = 12_000  # between a ping and the moment that its reading tells: steps of the world
_SAME: Final = 0.10  # m between two echoes of one surface
_A_LITTLE: Final = 0.01  # m
_KEPT: Final = 60  # pings: of 10 s and a little more
_REMEMBERED_US: Final = 10_000_000  # for so long the guard knows what a sensor has heard that hears nothing now
_SLOW: Final = 0.16  # m/s at which that may be touched
_TOUCHES: Final = 1e-3  # m
_THERE: Final = 0.5  # m between where a surface gave its echo and where it is touched


class _Ping:
    """A ping of a sound sensor, and what it must have heard."""

    def __init__(self, at_us: int, sonar: Sonar, heard: tuple[Pose, Hit | None, int]) -> None:
        self.at_us = at_us
        self._sonar = sonar
        self._pose, self._echo, self._version = heard

    def echo(self, version: int) -> Hit | None:
        """As far as it is still there: what has come, gone or moved far since then was not heard."""
        if version != self._version and self._echo is not None:
            self._version = version
            now = self._sonar.sure_echo(self._pose)
            same = now is not None and abs(now.distance - self._echo.distance) <= _SAME
            self._echo = now if same else None
        return self._echo

    def heard_at(self, x: float, y: float, version: int) -> int | None:
        """The surface, if it gave its echo at about this place and nothing nearer might have been heard instead."""
        echo = self.echo(version)
        if echo is None or math.dist(self._sonar.echo_point(self._pose, echo), (x, y)) > _THERE:
            return None
        return echo.surface if min(self._sonar.hits(self._sonar.origin(self._pose))).surface == echo.surface else None


class Obstacles:
    """Looks at the world for what readings only tell."""

    def __init__(self, world: World, settings: Settings) -> None:
        self._world = world
        self._robot, self._sensors = settings.robot, settings.robot.of(Ultrasonic)
        self._deceleration = settings.guard.deceleration or math.inf
        self._new = NewPings(world, settings.robot)
        self._pings: dict[str, deque[_Ping]] = defaultdict(lambda: deque(maxlen=_KEPT))

    def note(self, now_us: int) -> None:
        """Take the pings of this step."""
        for name, sonar in self._new.pop_new():
            if sonar.must_have_heard is not None:
                self._pings[name].append(_Ping(now_us, sonar, sonar.must_have_heard))

    def touched(self, readings: Mapping[str, deque[Heard]]) -> str:
        """Where the body touches, and what the sensors told last."""
        plant = self._world.plant
        _, normal_x, normal_y = self._world.room.nearest(plant.pose.x, plant.pose.y)
        bearing = math.degrees(math.remainder(math.atan2(-normal_y, -normal_x) - plant.pose.yaw, math.tau))
        told = (
            f"{name} {heard[-1].reading.range:.2f} m" if heard[-1].reading.range is not None else f"{name} nothing"
            for name, heard in sorted(readings.items())
            if heard
        )
        return f"{bearing:+.0f} degrees from ahead, at {plant.speed:+.2f} m/s; {', '.join(told)}"

    def touched_too_fast(self, now_us: int) -> str:
        """How fast the body touches what a sensor that is deaf now has heard before; empty when it does not."""
        speed = self._world.plant.speed
        if abs(speed) <= _SLOW:
            return ""
        for name, mount in self._sensors.items():
            is_deaf = self._world.sonars[mount.index].fault is SonarFault.DEAF
            if not is_deaf or not looks_along(mount, speed):
                continue
            if (heard_us := self._heard_twice_us(name, now_us)) is not None:
                ago = (now_us - heard_us) / 1e6
                return f"{speed:+.2f} m/s at the touch of what {name} heard {ago:.1f} s ago, before it was deaf"
        return ""

    def _heard_twice_us(self, name: str, now_us: int) -> int | None:
        """When the second of two successive pings heard the place that the body touches now."""
        room, pose = self._world.room, self._world.plant.pose
        distance, normal_x, normal_y = room.nearest(pose.x, pose.y)
        x, y = pose.x - distance * normal_x, pose.y - distance * normal_y
        later_us, later = 0, None
        for ping in reversed(self._pings[name]):
            if now_us - ping.at_us > _REMEMBERED_US:
                return None
            surface = ping.heard_at(x, y, room.version)
            if surface is not None and self._clearance(surface) > _TOUCHES:
                surface = None
            if surface is not None and surface == later and later_us - ping.at_us <= _TWO_CYCLES_US:
                return later_us
            later_us, later = ping.at_us, surface
        return None

    def ahead(self, linear: float, readings: Mapping[str, deque[Heard]], now_us: int) -> str:
        """What the motors drive at, where `linear` (m/s) is the frame's; empty when nothing is too near."""
        room = self._world.room
        stopping = linear * linear / (2.0 * self._deceleration)
        for name, mount in self._sensors.items():
            if not looks_along(mount, linear):
                continue
            handed = readings[name]
            for heard in handed:
                if now_us - heard.at_us < _REACTION_US or now_us - heard.born_us > _TWO_CYCLES_US:
                    continue
                ping = self._ping_of(name, heard.born_us)
                echo = ping.echo(room.version) if ping is not None else None
                if echo is None:
                    continue
                clearance = self._clearance(echo.surface)
                if self._clearance(echo.surface, math.copysign(_A_LITTLE, linear)) >= clearance:
                    continue
                # A post is passed by as near as its edge allows; a wall is what the robot comes to rest before.
                least = stopping if echo.round or heard is not handed[-1] else stopping + REST
                if clearance < least:
                    return (
                        f"{linear:.2f} m/s towards what {name} must have heard at {echo.distance:.2f} m "
                        f"{(now_us - heard.at_us) / 1e6:.3f} s ago, now {clearance:.2f} m from the body"
                    )
        return ""

    def _ping_of(self, name: str, born_us: int) -> _Ping | None:
        return next((ping for ping in reversed(self._pings[name]) if abs(ping.at_us - born_us) <= _SAME_US), None)

    def _clearance(self, surface: int, step: float = 0.0) -> float:
        """m between the body and a surface, now or after `step` m ahead."""
        x, y, yaw = self._world.plant.pose
        distance = self._world.room.distance(surface, x + step * math.cos(yaw), y + step * math.sin(yaw))
        return distance - self._robot.footprint_radius
