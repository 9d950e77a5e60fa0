"""The ultrasonic sensors that look along one direction, and the room that their readings leave there."""

import math
from functools import lru_cache

from giraff_core.kinematics.pose import Pose
from giraff_guard.judge.direction import ALONG
from giraff_guard.limits import SIGN, DriveDirection, Limits
from giraff_guard.motion import RecentTravel
from giraff_guard.senses.ultrasonic.sensor import Sensor
from giraff_guard.senses.ultrasonic.silence_trust import Ping
from giraff_guard.source import Reading, Sight
from giraff_schemas.messages import RobotTime
from giraff_schemas.trouble import NO_TROUBLE, Trouble


class Facing:
    """The sensors of one direction."""

    def __init__(self, way: DriveDirection, limits: Limits, sensors: list[Sensor]) -> None:
        self._limits = limits
        self.sensors = [sensor for sensor in sensors if SIGN[way] * math.cos(sensor.mount.yaw) > ALONG]
        self._others = {each.name: [other for other in self.sensors if other is not each] for each in self.sensors}
        self._asides = {sensor.name: self._aside(sensor) for sensor in self.sensors}

    def sight(self, sensor: Sensor, motion: RecentTravel, now: RobotTime) -> Sight:
        """Return what one of its sensors tells of the direction."""
        newest, blind = sensor.newest, sensor.blindness()
        sight = Sight(
            sensor.name,
            blind=blind,
            silent_s=sensor.silence_s(now) if sensor.is_silent else None,
            aside=sensor.mount.y,
            newest=newest.distance if newest is not None else None,
        )
        if blind:
            return sight
        doubt, touch, config = sensor.distrust(motion, now), NO_TROUBLE, self._limits.config
        if sensor.lost(motion):
            touch = Trouble(f"{sensor.name} lost something nearer than {config.touch_distance:g} m")
        return sight._replace(
            touch=touch,
            readings=[self._reading(sensor, ping, motion.place) for ping in sensor.counted(self._others[sensor.name])],
            doubt=doubt,
            doubtful_speed=sensor.allowed_speed(motion, now, self._limits.most) if doubt else math.inf,
        )

    def gap(self, sensor: Sensor, distance: float) -> float:
        """m between the footprint and what `distance` told, at the least.

        The worst of a flat surface at up to `incidence`: the echo then comes from the cone's near edge, and the
        surface is nearest beside the sensor's axis. A sensor off the middle is charged for its offset only where no
        other one sits farther over: a surface that is nearer on that side is nearer to the other sensor there.
        """
        share, ahead, beside = _charge(sensor.offset, self._asides[sensor.name], sensor.incidence, sensor.half_cone)
        return distance * share + ahead - beside - self._limits.footprint_radius

    def _reading(self, sensor: Sensor, ping: Ping, place: Pose) -> Reading:
        came = ping.place.ahead(place, sensor.mount.yaw)
        return Reading(self.gap(sensor, ping.distance), came, ping.distance, ping.echo)

    def _aside(self, sensor: Sensor) -> float:
        """Return m off the middle that a sensor is charged for."""
        aside = abs(sensor.aside)
        if any(other.aside * sensor.aside < sensor.aside**2 for other in self.sensors):
            aside = 0.0
        return aside


@lru_cache(maxsize=64)
def _charge(offset: float, aside: float, incidence: float, half_cone: float) -> tuple[float, float, float]:
    """Return the share of a distance that counts, m that the sensor sits ahead, and m taken off for its place.

    Each reading asks for them several times, and a parameter that is set changes them.
    """
    ahead = min(offset, offset * math.cos(incidence))
    return math.cos(max(0.0, incidence - half_cone)), ahead, aside * math.sin(incidence)
