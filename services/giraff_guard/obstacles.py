"""Obstacles and blind directions: what ranges and wheels allow, and what is let through of a twist."""

from __future__ import annotations

import math
from typing import NamedTuple

from giraff_core.freshness import age
from giraff_core.live import Live
from giraff_core.robot import RobotConfig
from giraff_guard.config import GuardConfig
from giraff_guard.directions import Direction, with_way_out
from giraff_guard.echoes import Echoes
from giraff_guard.motion import Motion
from giraff_guard.sensor import Sensor
from giraff_schemas.messages import Range, RobotTime, Verdict, Wheels
from giraff_schemas.trouble import WELL, Trouble


class Verdicts(NamedTuple):
    """What is allowed in each direction now."""

    forward: Verdict
    backward: Verdict
    turn_left: Verdict
    turn_right: Verdict
    sensors: dict[str, Trouble]
    """By sensor: why it is not trusted."""


class Limited(NamedTuple):
    """What is let through of a twist."""

    linear_x: float
    angular_z: float
    reason: Trouble
    """Why it is less than asked."""
    range_tick: RobotTime | None
    """Oldest moment of the readings that the motion asked for relies on, whatever passes; None: it relies on none."""


class Obstacles:
    """Feed it admitted readings and wheel reports; judge, then limit, once a decision."""

    def __init__(self, live: Live[GuardConfig], robot: RobotConfig) -> None:
        self._live = live
        self._robot = robot
        self._begin()

    def on_range(self, reading: Range, now: RobotTime) -> bool:
        """A reading newer than the last of its sensor. One of a sensor that the robot file lacks says nothing.

        True: less may pass now than has passed last.
        """
        sensor = self._sensors.get(reading.sensor)
        if sensor is None:
            return False
        self._motion.look(now)
        sensor.on_range(reading, self._motion, now)
        for direction in (self._forward, self._backward):
            direction.on_reading(sensor)
        ping = sensor.newest
        if ping is not None and self._motion.heard:
            self._echoes.take(sensor, ping, self._motion.travel)
        if self._asked == (0.0, 0.0):
            return False
        self.judge(now)
        allowed, passed = self._limited(*self._asked, now), self._passed
        return abs(allowed.linear_x) < abs(passed.linear_x) or abs(allowed.angular_z) < abs(passed.angular_z)

    def on_wheels(self, wheels: Wheels, now: RobotTime) -> None:
        """A report newer than the last; one of no known age says nothing."""
        if not math.isfinite(age(wheels.tick, now)):
            return
        breaks = self._motion.breaks
        self._motion.on_wheels(wheels)
        if self._motion.breaks != breaks:
            self._echoes.clear()  # nobody knows where they are now
        self._motion.look(now)

    def forget(self) -> None:
        """A new epoch: nothing that was remembered has a known age."""
        self._begin()

    def judge(self, now: RobotTime) -> Verdicts:
        """The verdict for each direction now."""
        motion = self._motion
        motion.look(now)
        self._echoes.forget(now.robot_ns, motion.travel)
        forward = self._forward.judge(motion, self._echoes, now)
        backward = self._backward.judge(motion, self._echoes, now)
        turn = self._turn()
        self._verdicts = Verdicts(
            forward=with_way_out(forward, self._forward, other_is_free=backward.allowed > 0.0),
            backward=with_way_out(backward, self._backward, other_is_free=forward.allowed > 0.0),
            turn_left=turn,
            turn_right=turn,
            sensors={
                name: sensor.blindness(now) or sensor.doubt(motion, now) for name, sensor in self._sensors.items()
            },
        )
        return self._verdicts

    def limit(self, linear_x: float, angular_z: float, now: RobotTime) -> Limited:
        """What is let through of a twist, by the verdicts of this turn."""
        limited = self._limited(linear_x, angular_z, now)
        self._asked, self._passed = (linear_x, angular_z), limited
        self._motion.on_passed(limited.linear_x, limited.angular_z, now)
        return limited

    def _limited(self, linear_x: float, angular_z: float, now: RobotTime) -> Limited:
        """What may be let through of a twist."""
        linear, angular, reason = self._within_the_robots_means(linear_x, angular_z)
        range_tick = None
        if linear != 0.0:
            direction = self._forward if linear > 0.0 else self._backward
            verdict = self._verdicts.forward if linear > 0.0 else self._verdicts.backward
            allowed, why = self._on_this_path(verdict, direction, angular / linear, now)
            if allowed == 0.0:
                # Nothing is left of the curve: the rotation is judged alone, and passes slowly. Never a trap.
                linear = 0.0
                angular = math.copysign(min(abs(angular), self._live.config.creep_angular), angular)
                reason = why.of(f"{direction.way} blocked")
            elif allowed < abs(linear):
                share = allowed / abs(linear)  # of both: the curvature is the operator's
                linear, angular = linear * share, angular * share
                why = why or Trouble(f"this robot drives at {allowed:g} m/s at most")
                reason = why.of(f"{direction.way} slowed")
            range_tick = direction.relied_on(now)
        if linear == 0.0:
            turn = self._verdicts.turn_left
            if abs(angular) > turn.allowed:
                angular = math.copysign(turn.allowed, angular)
                reason = reason or Trouble(f"turning slowed: {turn.reason}")
        return Limited(linear, angular, reason, range_tick)

    def _begin(self) -> None:
        live, robot = self._live, self._robot
        self._motion = Motion(live, robot)
        self._echoes = Echoes(live, robot.footprint_radius)
        self._sensors = {name: Sensor(name, pose, live) for name, pose in robot.sensors.items()}
        sensors = list(self._sensors.values())
        self._forward = Direction("forward", live, robot, sensors)
        self._backward = Direction("backward", live, robot, sensors)
        unjudged = Verdict(allowed=0.0, freedom="blocked", sensor="", reason="nothing is judged yet", way_out="wait")
        self._verdicts = Verdicts(unjudged, unjudged, unjudged, unjudged, {})
        self._asked = (0.0, 0.0)  # when it was limited last, and what has passed of it
        self._passed = Limited(0.0, 0.0, WELL, None)

    def _turn(self) -> Verdict:
        """Turning in place sweeps nothing beyond the footprint's disc; what touches that is turned past slowly."""
        largest = self._robot.max_angular_speed
        creep = self._live.config.creep_angular
        sensor = self._echoes.touching(self._motion.place)
        if not sensor or creep >= largest:
            return Verdict(allowed=largest, freedom="free", sensor="", reason="", way_out="")
        reason = f"{sensor} has heard something that touches the robot's side"
        return Verdict(allowed=creep, freedom="creep", sensor=sensor, reason=reason, way_out="")

    def _within_the_robots_means(self, linear: float, angular: float) -> tuple[float, float, Trouble]:
        largest = self._robot.max_angular_speed
        if abs(angular) <= largest:
            return linear, angular, WELL
        share = largest / abs(angular)
        slower = Trouble(f"slowed: this robot turns at {largest:g} rad/s at most")
        return linear * share, math.copysign(largest, angular), slower

    def _on_this_path(
        self, verdict: Verdict, direction: Direction, curvature: float, now: RobotTime
    ) -> tuple[float, Trouble]:
        """The speed along a curve and why: a curve sweeps what straight ahead does not."""
        why = Trouble(verdict.reason, verdict.way_out)
        swept = self._echoes.in_the_way(self._motion.place, direction.sign, now.robot_ns, curvature)
        obstruction = min(swept, key=direction.speed_towards, default=None)
        if obstruction is None:
            return verdict.allowed, why
        allowed = direction.speed_towards(obstruction)
        if allowed >= verdict.allowed:
            return verdict.allowed, why
        side = "left" if obstruction.bearing > 0.0 else "right"
        why = Trouble(f"this curve sweeps what {obstruction.sensor} has heard to the {side}", "turn the other way")
        return (allowed if allowed >= self._live.config.slowest else 0.0), why
