"""What the ultrasonic sensors say about driving forward and backward."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Mapping
from typing import Literal

from giraff_guard.config import GuardConfig
from giraff_guard.stopping import fastest, stopping_distance
from giraff_node.freshness import age
from giraff_node.robot import RobotConfig, SensorPose
from giraff_schemas.messages import Range, RobotTime, Verdict

Way = Literal["forward", "backward"]

_OTHER: dict[Way, str] = {"forward": "turn, or back up", "backward": "turn, or drive forward"}


class Direction:
    """One way along x, judged by the sensors that look along it.

    A blocked way opens again only `release` beyond the margin, so that a reading at the margin does not make the
    robot stutter.
    """

    def __init__(self, way: Way, config: GuardConfig, robot: RobotConfig) -> None:
        self.way: Way = way
        self._config = config
        self._robot = robot
        sign = 1.0 if way == "forward" else -1.0
        self.sensors = {name: pose for name, pose in robot.sensors.items() if sign * math.cos(pose.yaw) > 0.7}
        self._blocked = False
        self._speeds: deque[tuple[int, float]] = deque()  # (robot_ns, m/s), as far back as a reading may lie

    def judge(self, ranges: Mapping[str, Range], speed: float, now: RobotTime) -> Verdict:
        """The verdict for now. `speed`: what the robot does this way already, m/s, never negative."""
        self._speeds.append((now.robot_ns, speed))
        while (now.robot_ns - self._speeds[0][0]) * 1e-9 > self._config.range_budget:
            self._speeds.popleft()
        if not self.sensors:
            return Verdict(
                allowed=self._config.creep_linear,
                freedom="creep",
                sensor="",
                reason=f"no sensor looks {self.way}",
                way_out="",
            )
        for name in self.sensors:
            if blindness := self._blindness(name, ranges.get(name), now):
                self._blocked = True
                return Verdict(allowed=0.0, freedom="blocked", sensor=name, reason=blindness, way_out=_OTHER[self.way])
        verdicts = [self._judge_sensor(name, ranges[name], speed, now) for name in self.sensors]
        verdict = min(verdicts, key=lambda each: each.allowed)
        self._blocked = verdict.freedom == "blocked"
        return verdict

    def oldest_tick(self, ranges: Mapping[str, Range], now: RobotTime) -> RobotTime | None:
        """The oldest moment among the readings this way relies on; the epoch's beginning where one is missing."""
        ticks = [ranges[name].tick if name in ranges else None for name in self.sensors]
        beginning = RobotTime(epoch=now.epoch, robot_ns=0)
        proven = [tick if tick is not None and tick.epoch == now.epoch else beginning for tick in ticks]
        return min(proven, key=lambda tick: tick.robot_ns, default=None)

    def _blindness(self, name: str, reading: Range | None, now: RobotTime) -> str:
        """Why the sensor does not count; empty when it does."""
        if reading is None:
            return f"{name} has not been heard yet; start giraff_ranger"
        if reading.state == "fault":
            return f"{name} is faulty: {reading.reason}"
        old = age(reading.tick, now)
        if old > self._config.range_budget:
            last = f"{old:.1f} s old" if math.isfinite(old) else "of no known age"
            return f"{name} is stale ({last}); check giraff_ranger and its board"
        return ""

    def _judge_sensor(self, name: str, reading: Range, speed: float, now: RobotTime) -> Verdict:
        config = self._config
        distance = reading.range if reading.range is not None else config.reach
        old = age(reading.tick, now)
        room = self._clearance(self.sensors[name], distance) - config.margin
        # Since the reading the robot came nearer, by what it was fastest at: it may have been faster then than now.
        came = old * max(then for at, then in self._speeds if at >= now.robot_ns - old * 1e9)
        allowed = min(
            fastest(room, config.reaction_time + old, config.deceleration),
            fastest(room - came, config.reaction_time, config.deceleration),
        )
        seen = f"{name} sees something at {distance:.2f} m"
        too_close = room < config.release if self._blocked else room <= 0.0
        if too_close or allowed < config.slowest:
            return Verdict(allowed=0.0, freedom="blocked", sensor=name, reason=seen, way_out=_OTHER[self.way])
        if came + stopping_distance(speed, config.reaction_time, config.deceleration) > room:
            # The robot is faster than it may be: power off brakes harder than a lower level does.
            return Verdict(
                allowed=0.0,
                freedom="blocked",
                sensor=name,
                reason=f"{seen}, braking",
                way_out=_OTHER[self.way],
            )
        if allowed < self._robot.max_wheel_speed:
            return Verdict(allowed=allowed, freedom="slow", sensor=name, reason=seen, way_out="")
        return Verdict(allowed=self._robot.max_wheel_speed, freedom="free", sensor="", reason="", way_out="")

    def _clearance(self, pose: SensorPose, distance: float) -> float:
        """m between the footprint and what `distance` told, at the least.

        The worst of a flat surface at up to `incidence`: the echo then comes from the cone's near edge, and the
        surface is nearest beside the sensor's axis. A sensor off the middle is not charged for its offset, because
        a surface that is nearer on the other side is nearer to the sensor there.
        """
        incidence, half_cone = self._config.incidence, self._config.half_cone
        ahead = pose.x * math.cos(pose.yaw) + pose.y * math.sin(pose.yaw)  # of base_link, along the sensor's axis
        ahead = min(ahead, ahead * math.cos(incidence))
        return distance * math.cos(max(0.0, incidence - half_cone)) + ahead - self._robot.footprint_radius
