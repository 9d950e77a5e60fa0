"""How fast the robot may drive forward and backward, why not faster, and the way out."""

from __future__ import annotations

import math
from typing import Final, Literal

import msgspec

from giraff_core.freshness import age
from giraff_core.live import Live
from giraff_core.robot import RobotConfig
from giraff_guard.config import GuardConfig
from giraff_guard.echoes import Echoes, Obstruction
from giraff_guard.motion import Motion
from giraff_guard.recent_obstacles import RecentObstacles
from giraff_guard.sensor import Ping, Sensor
from giraff_guard.stopping import fastest, stopping_distance
from giraff_schemas.messages import Freedom, RobotTime, Verdict

Way = Literal["forward", "backward"]

_UNMEASURED: Final = 0.5
"""m/s² that a robot of unknown deceleration is taken to brake with from creeping."""
_ASIDE: Final = 0.10
"""m of difference between left and right from which one side counts as the freer one."""
_STUTTER: Final = 1.5
"""Times the speed that is allowed: a robot that is hardly too fast is slowed by its level, not braked in turns."""


class Direction:
    """One way along x, judged by the sensors that look along it.

    A way that was blocked is released to creep, and each further reading of the sensor that blocked it adds speed.
    """

    def __init__(self, way: Way, live: Live[GuardConfig], robot: RobotConfig, sensors: list[Sensor]) -> None:
        self.way: Way = way
        self.sign = 1.0 if way == "forward" else -1.0
        self._live = live
        self._robot = robot
        self.sensors = [sensor for sensor in sensors if self.sign * math.cos(sensor.pose.yaw) > 0.7]
        self._held = RecentObstacles(live, robot.footprint_radius)
        self._blocked = True
        self._blocker = ""
        """The sensor that blocked this way last."""
        self._regained = 0.0
        """m/s beyond creeping that its readings since then allow."""

    def on_reading(self, sensor: Sensor) -> None:
        """A sensor was heard."""
        if not self._blocked and sensor.name == self._blocker:
            self._regained += self._live.config.regain
        ping = sensor.heard
        if sensor in self.sensors and ping is not None and ping is sensor.newest:
            self._held.take(sensor, ping, is_sure=ping is sensor.surest)

    def judge(self, motion: Motion, echoes: Echoes, now: RobotTime) -> Verdict:
        """The verdict for now, without the way out."""
        verdicts = [self._by_sensor(sensor, motion, now) for sensor in self.sensors]
        remembered = echoes.in_the_way(motion.place, self.sign, now.robot_ns)
        if obstruction := min(remembered, key=self.speed_towards, default=None):
            verdicts.append(self._by_memory(obstruction))
        self._held.forget(now.robot_ns)
        if silent := [sensor for sensor in self.sensors if sensor.is_silent]:
            verdicts.extend(self._by_held(silent, motion, now))
        if not self.sensors:
            verdicts.append(self._creep("", f"no sensor looks {self.way}"))
        if self._live.config.deceleration is None:
            verdicts.append(self._creep("", "deceleration has not been measured; measure it, and set it in [guard]"))
        verdict = min(verdicts, key=lambda each: each.allowed)
        self._blocked = verdict.freedom == "blocked"
        if self._blocked:
            self._blocker, self._regained = verdict.sensor, 0.0
        elif (allowed := self._live.config.creep_linear + self._regained) < verdict.allowed:
            reason = "this way was blocked until just now; speeding up"
            return self._verdict(allowed, verdict.sensor, reason)
        return verdict

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

    def speed_towards(self, obstruction: Obstruction) -> float:
        """m/s from which the robot stops `margin` before what is remembered; slow at least where that is old.

        Of that margin the strip that is swept already holds `memory_margin`; beside it, no more is kept: a way past
        what was heard stays one.
        """
        config = self._live.config
        room = obstruction.distance - max(0.0, config.margin - config.memory_margin)
        allowed = self._fastest(room)
        return max(allowed, config.unproved_linear) if obstruction.is_old else allowed

    def _by_sensor(self, sensor: Sensor, motion: Motion, now: RobotTime) -> Verdict:
        if blindness := sensor.blindness(now):
            return self._block(sensor.name, str(blindness))
        if sensor.lost(motion):
            return self._block(sensor.name, f"{sensor.name} lost something nearer than {self._live.config.near:g} m")
        believed = sensor.believed([other for other in self.sensors if other is not sensor])
        # The newest first, so that of equal ones it is the one named.
        verdict = min((self._by_ping(sensor, ping, motion, now) for ping in believed), key=lambda each: each.allowed)
        if verdict.allowed <= self._live.config.creep_linear:
            return verdict
        if doubt := sensor.doubt(motion, now):
            allowed = sensor.worth(motion, now, self._robot.max_wheel_speed)
            return self._verdict(allowed, sensor.name, str(doubt)) if allowed < verdict.allowed else verdict
        return verdict

    def _by_ping(self, sensor: Sensor, ping: Ping, motion: Motion, now: RobotTime) -> Verdict:
        config = self._live.config
        room = self._clearance(sensor, ping.distance) - config.margin
        came = ping.place.ahead(motion.place, sensor.pose.yaw)
        allowed = self._fastest(room - came)
        if ping is sensor.newest and sensor.tick is not None:
            # As if it had gone on at that speed since the reading, whatever the wheels say.
            allowed = min(allowed, self._fastest(room, age(sensor.tick, now)))
        seen = f"{sensor.name} sees something at {ping.distance:.2f} m"
        too_close = room - came < config.release if self._blocked else room <= 0.0
        if too_close or allowed < config.slowest:
            return self._block(sensor.name, seen)
        if came + self._stops_within(motion.speed(self.sign)) > room:
            # The robot is faster than it may be: power off brakes harder than a lower level does.
            return self._block(sensor.name, f"{seen}, braking")
        return self._verdict(allowed, sensor.name, seen)

    def _by_held(self, silent: list[Sensor], motion: Motion, now: RobotTime) -> list[Verdict]:
        """Towards where something was heard until lately: what hears nothing there now may have gone deaf.

        It blocks for a moment, and says so; then it may be approached as slowly as what no sensor has proved.
        """
        config, names = self._live.config, " and ".join(sensor.name for sensor in silent)
        slow = config.unproved_linear
        verdicts = []
        if heard := self._held.ahead(motion.place, self.sign):
            room, speed = heard.distance - config.margin, motion.speed(self.sign)
            reason = f"{names}: silent where {heard.sensor} heard something until lately"
            if self._stops_within(speed) > room and (
                speed > _STUTTER * slow or min(sensor.quiet(now) for sensor in silent) < config.held_block
            ):
                verdicts.append(self._block(silent[0].name, reason))
            else:
                allowed = max(slow, self._fastest(room))
                verdicts.append(self._verdict(allowed, silent[0].name, reason))
        if heard := self._held.beside(motion.place, self.sign):
            reason = f"{names}: silent beside where {heard.sensor} heard something until lately"
            verdicts.append(self._verdict(max(slow, self._fastest(heard.distance)), silent[0].name, reason))
        return verdicts

    def _by_memory(self, obstruction: Obstruction) -> Verdict:
        allowed = self.speed_towards(obstruction)
        side = "left" if obstruction.bearing > 0.0 else "right"
        reason = f"{obstruction.sensor} has heard something to the {side}, where no sensor looks now"
        if allowed < self._live.config.slowest:
            return self._block(obstruction.sensor, reason)
        return self._verdict(allowed, obstruction.sensor, reason)

    def _fastest(self, room: float, old: float = 0.0) -> float:
        """m/s from which the robot stops within `room` m, by what is `old` s old."""
        config = self._live.config
        return fastest(room, config.reaction_time + old, config.deceleration or _UNMEASURED)

    def _stops_within(self, speed: float) -> float:
        """m that it takes to stop from `speed` (m/s)."""
        return stopping_distance(speed, self._live.config.reaction_time, self._live.config.deceleration or _UNMEASURED)

    def _block(self, sensor: str, reason: str) -> Verdict:
        return Verdict(allowed=0.0, freedom="blocked", sensor=sensor, reason=reason, way_out="")

    def _creep(self, sensor: str, reason: str) -> Verdict:
        return self._verdict(self._live.config.creep_linear, sensor, reason)

    def _verdict(self, allowed: float, sensor: str, reason: str) -> Verdict:
        if allowed >= self._robot.max_wheel_speed:
            free = self._robot.max_wheel_speed
            return Verdict(allowed=free, freedom="free", sensor="", reason="", way_out="")
        freedom: Freedom = "creep" if allowed <= self._live.config.creep_linear else "slow"
        return Verdict(allowed=allowed, freedom=freedom, sensor=sensor, reason=reason, way_out="")

    def _clearance(self, sensor: Sensor, distance: float) -> float:
        """m between the footprint and what `distance` told, at the least.

        The worst of a flat surface at up to `incidence`: the echo then comes from the cone's near edge, and the
        surface is nearest beside the sensor's axis. A sensor off the middle is charged for its offset only where no
        other one sits farther over: a surface that is nearer on that side is nearer to the other sensor there.
        """
        incidence, half_cone = self._live.config.incidence, self._live.config.half_cone
        ahead = min(sensor.offset, sensor.offset * math.cos(incidence))
        aside = abs(sensor.aside)
        if any(other.aside * sensor.aside < sensor.aside**2 for other in self.sensors):
            aside = 0.0
        slanted = distance * math.cos(max(0.0, incidence - half_cone))
        return slanted + ahead - aside * math.sin(incidence) - self._robot.footprint_radius


def with_way_out(verdict: Verdict, way: Direction, *, other_is_free: bool) -> Verdict:
    """A blocked verdict with what the operator can do instead."""
    if verdict.freedom != "blocked":
        return verdict
    turn = f"turn {way.freer_side()}".strip()
    back = "back up" if way.way == "forward" else "drive forward"
    return msgspec.structs.replace(verdict, way_out=f"{turn} or {back}" if other_is_free else turn)
