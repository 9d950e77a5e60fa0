"""What the sensors of one way hear: the speed from which the robot stops before it, and blindness."""

import math
from functools import lru_cache
from operator import attrgetter
from typing import Final, NamedTuple

from giraff_core.freshness import age
from giraff_guard.limits import SIGN, DriveDirection, Limits
from giraff_guard.motion import RecentTravel
from giraff_guard.ultrasonic.sensor import Sensor
from giraff_guard.ultrasonic.silence_trust import Ping
from giraff_schemas.messages import DirectionLimit, RobotTime
from giraff_schemas.trouble import Trouble

_ROLLS: Final = "the robot would first roll back towards it"


class _PingLimit(NamedTuple):
    """What one reading allows."""

    allowed: float
    """m/s; 0 where it blocks."""
    ping: Ping
    is_braking: bool = False
    """It blocks because the robot is faster than it may be."""


class Nearest:
    """Judges the sensors of one way."""

    def __init__(self, way: DriveDirection, limits: Limits, sensors: list[Sensor]) -> None:
        self._sign = SIGN[way]
        self._limits = limits
        self._sensors = sensors
        self._others = {sensor.name: [other for other in sensors if other is not sensor] for sensor in sensors}
        self._asides = {sensor.name: self._aside(sensor) for sensor in sensors}

    def verdict(self, sensor: Sensor, motion: RecentTravel, now: RobotTime, *, blocked: bool) -> DirectionLimit:
        """What one sensor allows. `blocked`: the way was blocked, and needs more room to be opened again."""
        limits, config = self._limits, self._limits.config
        if blindness := sensor.blindness(now):
            return limits.block(sensor.name, blindness)
        if sensor.lost(motion):
            return limits.block(
                sensor.name, Trouble(f"{sensor.name} lost something nearer than {config.touch_distance:g} m")
            )
        stops_within = limits.stops_within(motion.speed(self._sign))
        # The newest first, so that of equal ones it is the one named.
        judged = [
            self._by_ping(sensor, ping, motion, now, stops_within, blocked=blocked)
            for ping in sensor.counted(self._others[sensor.name])
        ]
        verdict = self._verdict_of(sensor, min(judged, key=attrgetter("allowed")))
        if verdict.allowed <= config.creep_linear:
            return verdict
        if doubt := sensor.distrust(motion, now):
            allowed = sensor.allowed_speed(motion, now, limits.most)
            return limits.allow(allowed, sensor.name, doubt) if allowed < verdict.allowed else verdict
        return verdict

    def room(self, sensor: Sensor, motion: RecentTravel, now: RobotTime) -> float:
        """Return m beyond the footprint that one sensor knows to be free. Without proof, its silence tells nothing."""
        if sensor.blindness(now) or sensor.lost(motion) or sensor.distrust(motion, now):
            return 0.0
        counted = sensor.counted(self._others[sensor.name])
        return min(self._left(sensor, ping, motion) for ping in counted)

    def opposite(self, sensor: Sensor, motion: RecentTravel, now: RobotTime, *, blocked: bool) -> DirectionLimit | None:
        """Limit the other way by one sensor of this way, to which the robot first rolls back; None: not at all.

        `blocked`: this sensor blocked it last. A silence limits nothing.
        """
        limits, config = self._limits, self._limits.config
        if blindness := sensor.blindness(now):
            return limits.creep(sensor.name, blindness)
        counted = sensor.counted(self._others[sensor.name])
        echoes = [ping for ping in counted if ping.echo]
        room = min((self._left(sensor, ping, motion) for ping in echoes), default=math.inf)
        if room < config.room_behind + (config.release if blocked else 0.0):
            seen = min(ping.distance for ping in echoes)
            return limits.block(sensor.name, Trouble(f"{sensor.name} sees something at {seen:.2f} m, and {_ROLLS}"))
        if sensor.lost(motion):
            lost = f"{sensor.name} lost something nearer than {config.touch_distance:g} m"
            return limits.block(sensor.name, Trouble(f"{lost}, and {_ROLLS}"))
        return None

    def _left(self, sensor: Sensor, ping: Ping, motion: RecentTravel) -> float:
        """m between the footprint and what a reading told, as the robot has moved since."""
        return self.gap(sensor, ping.distance) - ping.place.ahead(motion.place, sensor.pose.yaw)

    def _by_ping(
        self, sensor: Sensor, ping: Ping, motion: RecentTravel, now: RobotTime, stops_within: float, *, blocked: bool
    ) -> _PingLimit:
        """Return what one reading allows. `stops_within`: m."""
        limits, config = self._limits, self._limits.config
        room = self.gap(sensor, ping.distance) - config.margin
        came = ping.place.ahead(motion.place, sensor.pose.yaw)
        allowed = limits.fastest(room - came)
        if ping is sensor.newest and sensor.tick is not None:
            # As if it had gone on at that speed since the reading, whatever the wheels say.
            allowed = min(allowed, limits.fastest(room, age(sensor.tick, now)))
        too_close = room - came < config.release if blocked else room <= 0.0
        if too_close or allowed < config.min_speed:
            return _PingLimit(0.0, ping)
        if came + stops_within > room:
            # The robot is faster than it may be: power off brakes harder than a lower level does.
            return _PingLimit(0.0, ping, is_braking=True)
        return _PingLimit(min(allowed, limits.most), ping)

    def _verdict_of(self, sensor: Sensor, limit: _PingLimit) -> DirectionLimit:
        seen = f"{sensor.name} sees something at {limit.ping.distance:.2f} m{', braking' if limit.is_braking else ''}"
        if limit.allowed > 0.0:
            return self._limits.allow(limit.allowed, sensor.name, Trouble(seen))
        return self._limits.block(sensor.name, Trouble(seen))

    def gap(self, sensor: Sensor, distance: float) -> float:
        """m between the footprint and what `distance` told, at the least.

        The worst of a flat surface at up to `incidence`: the echo then comes from the cone's near edge, and the
        surface is nearest beside the sensor's axis. A sensor off the middle is charged for its offset only where no
        other one sits farther over: a surface that is nearer on that side is nearer to the other sensor there.
        """
        share, ahead, beside = _charge(sensor.offset, self._asides[sensor.name], sensor.incidence, sensor.half_cone)
        return distance * share + ahead - beside - self._limits.footprint_radius

    def _aside(self, sensor: Sensor) -> float:
        """Return m off the middle that a sensor is charged for."""
        aside = abs(sensor.aside)
        if any(other.aside * sensor.aside < sensor.aside**2 for other in self._sensors):
            aside = 0.0
        return aside


@lru_cache(maxsize=64)
def _charge(offset: float, aside: float, incidence: float, half_cone: float) -> tuple[float, float, float]:
    """Return the share of a distance that counts, m that the sensor sits ahead, and m taken off for its place.

    Each reading asks for them several times, and a parameter that is set changes them.
    """
    ahead = min(offset, offset * math.cos(incidence))
    return math.cos(max(0.0, incidence - half_cone)), ahead, aside * math.sin(incidence)
