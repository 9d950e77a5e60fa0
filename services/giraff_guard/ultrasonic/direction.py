"""How fast the robot may drive forward or backward by its ultrasonic sensors, and why not faster."""

import math
from collections.abc import Iterator
from typing import Final

from giraff_guard.limits import OTHER, SIGN, DriveDirection, Limits
from giraff_guard.motion import RecentTravel
from giraff_guard.ultrasonic.held import RecentObstacles
from giraff_guard.ultrasonic.memory import Echoes
from giraff_guard.ultrasonic.nearest import Nearest
from giraff_guard.ultrasonic.sensor import Sensor
from giraff_schemas.messages import DirectionLimit, RobotTime
from giraff_schemas.trouble import Trouble

_ASIDE: Final = 0.10
"""m of difference between left and right from which one side counts as the freer one."""
_UNMEASURED: Final = Trouble("deceleration has not been measured", "measure it, and set it in [guard]")
_SPEEDS_UP: Final = Trouble("this way was blocked until just now", "wait, it speeds up by itself")


class UltrasonicDirection:
    """One way along x, judged by the sensors that look along it.

    A way that was blocked is released to creep, and each further reading of the sensor that blocked it adds speed.
    """

    def __init__(self, way: DriveDirection, limits: Limits, sensors: list[Sensor]) -> None:
        self._direction: DriveDirection = way
        self._limits = limits
        self.sensors = _along(way, sensors)
        self._nearest = Nearest(way, limits, self.sensors)
        self._behind = _along(OTHER[way], sensors)
        self._nearest_behind = Nearest(OTHER[way], limits, self._behind)
        self._held = RecentObstacles(way, limits)
        self._blocked = True
        self._blocker = ""
        """The sensor that blocked this way last."""
        self._regained = 0.0
        """m/s beyond creeping that its readings since then allow."""

    def on_reading(self, sensor: Sensor) -> None:
        """A sensor was heard."""
        if not self._blocked and sensor.name == self._blocker:
            self._regained += self._limits.config.recovery_step
        ping = sensor.heard
        if sensor in self.sensors and ping is not None and ping is sensor.newest:
            self._held.add(sensor, ping, is_sure=ping is sensor.last_confirmed)

    def judge(self, motion: RecentTravel, echoes: Echoes, now: RobotTime) -> DirectionLimit:
        """The verdict for now."""
        limits = self._limits
        verdicts = [self._nearest.verdict(sensor, motion, now, blocked=self._blocked) for sensor in self.sensors]
        verdicts.extend(echoes.verdicts(motion.place, self._direction, now.robot_ns))
        self._held.forget(now.robot_ns)
        if silent := [sensor for sensor in self.sensors if sensor.is_silent]:
            verdicts.extend(self._held.verdicts(silent, motion, now))
        if not self.sensors:
            verdicts.append(limits.creep("", Trouble(f"no sensor looks {self._direction}")))
        if limits.config.room_behind > 0.0:
            verdicts.extend(self._rolling_back(motion, now))
        if limits.config.deceleration is None:
            verdicts.append(limits.creep("", _UNMEASURED))
        verdict = min(verdicts, key=lambda each: each.allowed)
        self._blocked = verdict.clearance == "blocked"
        if self._blocked:
            self._blocker, self._regained = verdict.sensor, 0.0
        elif (allowed := limits.config.creep_linear + self._regained) < verdict.allowed:
            return limits.allow(allowed, verdict.sensor, _SPEEDS_UP)
        return verdict

    def _rolling_back(self, motion: RecentTravel, now: RobotTime) -> Iterator[DirectionLimit]:
        """What stands behind, or may: driving off, and after a stop, the robot rolls back."""
        if not self._behind:
            yield self._limits.creep(
                "", Trouble(f"no sensor looks {OTHER[self._direction]}, where the robot first rolls back")
            )
        for sensor in self._behind:
            blocked = self._blocked and self._blocker == sensor.name
            if verdict := self._nearest_behind.opposite(sensor, motion, now, blocked=blocked):
                yield verdict

    def room(self, motion: RecentTravel, echoes: Echoes, now: RobotTime) -> float:
        """Return m beyond the footprint that are known to be free; 0 without a sensor that looks there."""
        rooms = [self._nearest.room(sensor, motion, now) for sensor in self.sensors]
        rooms += [each.distance for each in echoes.in_the_way(motion.place, self._direction, now.robot_ns)]
        if any(sensor.is_silent for sensor in self.sensors) and (heard := self._held.ahead(motion.place)):
            rooms.append(heard.distance)
        return min(rooms) if self.sensors else 0.0

    def relied_on(self, now: RobotTime) -> RobotTime | None:
        """The oldest moment among the newest readings of this way's sensors, robot_ns 0 for one that never came."""
        never = RobotTime(epoch=now.epoch, robot_ns=0)
        ticks = [sensor.tick or never for sensor in self.sensors]
        return min(ticks, key=lambda tick: tick.robot_ns, default=None)

    def freer_side(self) -> str:
        """Where the sensors see farther: left, right, or neither."""
        left = [s.newest.distance for s in self.sensors if s.newest is not None and s.pose.y > 0.0]
        right = [s.newest.distance for s in self.sensors if s.newest is not None and s.pose.y < 0.0]
        difference = min(left, default=0.0) - min(right, default=0.0)
        if not left or not right or abs(difference) < _ASIDE:
            return ""
        return "left" if difference > 0.0 else "right"


def _along(way: DriveDirection, sensors: list[Sensor]) -> list[Sensor]:
    """Those that look this way."""
    return [sensor for sensor in sensors if SIGN[way] * math.cos(sensor.pose.yaw) > 0.7]
