"""The guard's whole policy. No I/O and no clock: time is an argument."""

from __future__ import annotations

import math

import msgspec

from giraff_guard.config import GuardConfig
from giraff_guard.directions import Direction
from giraff_node.freshness import age
from giraff_node.robot import RobotConfig
from giraff_schemas.messages import (
    DriveCommand,
    GuardedCommand,
    GuardState,
    Range,
    RobotTime,
    Tick,
    Verdict,
    Wheels,
)


class GuardPolicy:
    """The third of the four safety layers: authority, freshness, obstacles and blind directions.

    It must run on base's host: it reads the clock that base makes its ticks of.
    """

    def __init__(self, config: GuardConfig, robot: RobotConfig) -> None:
        self._config = config
        self._robot = robot
        self._forward = Direction("forward", config, robot)
        self._backward = Direction("backward", config, robot)
        self._tick: Tick | None = None
        self._command: DriveCommand | None = None
        self._heard_ns = 0
        self._ranges: dict[str, Range] = {}
        self._wheels: Wheels | None = None
        self._passed = 0.0  # m/s, forward positive

    def on_tick(self, tick: Tick) -> None:
        self._tick = tick

    def on_range(self, reading: Range) -> None:
        newest = self._ranges.get(reading.sensor)
        if newest is None or newest.instance != reading.instance or reading.seq > newest.seq:
            self._ranges[reading.sensor] = reading

    def on_wheels(self, wheels: Wheels) -> None:
        self._wheels = wheels

    def on_command(self, command: DriveCommand, robot_ns: int) -> None:
        """Take an operator's command. The first to be heard is in charge until it falls silent."""
        if self._tick is None:
            return
        now = RobotTime(epoch=self._tick.epoch, robot_ns=robot_ns)
        held = self._command
        if held is not None and held.instance == command.instance:
            if command.seq <= held.seq:
                return
        elif held is not None and (robot_ns - self._heard_ns) * 1e-9 <= self._config.operator_release:
            return
        self._command = command
        if age(command.tick, now) <= self._config.operator_budget:
            self._heard_ns = robot_ns

    def decide(self, robot_ns: int) -> tuple[GuardedCommand, GuardState]:
        """What to let through now, and the verdict for each direction. `robot_ns`: the robot's clock."""
        # Without a tick nothing is fresh: epoch 0 is nobody's.
        now = RobotTime(epoch=self._tick.epoch if self._tick else 0, robot_ns=robot_ns)
        speed = self._speed(now)
        forward = self._forward.judge(self._ranges, max(0.0, speed), now)
        backward = self._backward.judge(self._ranges, max(0.0, -speed), now)
        asked, refusal = self._asked(now)
        linear, angular, limit = self._limit(asked, forward, backward)
        self._passed = linear
        turn = self._turn(asked, forward, backward)
        relied_on = None
        if asked is not None and asked.linear_x != 0.0:
            direction = self._forward if asked.linear_x > 0.0 else self._backward
            relied_on = direction.oldest_tick(self._ranges, now)
        newest = self._command
        command = GuardedCommand(
            linear_x=linear,
            angular_z=angular,
            guard_tick=self._tick.time if self._tick else None,
            operator=newest.instance if newest else "",
            operator_tick=newest.tick if newest else None,
            range_tick=relied_on,
            source=newest.source if newest else "fault",
            hand_neutral=asked is not None and asked.neutral,
            reason=refusal or limit,
        )
        state = GuardState(
            forward=forward,
            backward=backward,
            turn_left=turn,
            turn_right=turn,
            operator=newest.instance if newest else "",
            reason=refusal or limit,
        )
        return command, state

    def _speed(self, now: RobotTime) -> float:
        """m/s the robot does, forward positive; what was passed on last where the wheels are not heard."""
        wheels = self._wheels
        if wheels is None or age(wheels.tick, now) > self._config.range_budget:
            return self._passed
        return (wheels.left_velocity + wheels.right_velocity) / 2.0

    def _asked(self, now: RobotTime) -> tuple[DriveCommand | None, str]:
        """The operator's command if it counts, else why it does not."""
        if self._tick is None:
            return None, "base is not heard; start giraff_base on this machine"
        command = self._command
        if command is None:
            return None, "no operator is heard; start giraff_joystick"
        if command.source == "fault":
            return None, f"operator: {command.reason}"
        old = age(command.tick, now)
        if old > self._config.operator_budget:
            last = f"is {old:.1f} s old" if math.isfinite(old) else "carries no moment of this robot's clock"
            return None, f"the operator's command {last}; check its link and giraff_joystick"
        return command, ""

    def _limit(self, asked: DriveCommand | None, forward: Verdict, backward: Verdict) -> tuple[float, float, str]:
        """The twist that is let through, and why it is less than asked."""
        if asked is None:
            return 0.0, 0.0, ""
        linear, angular = asked.linear_x, asked.angular_z
        limit = ""
        largest = self._robot.max_angular_speed
        if abs(angular) > largest:
            share = largest / abs(angular)
            linear, angular = linear * share, math.copysign(largest, angular)
            limit = f"slowed: this robot turns at {largest:g} rad/s at most"
        if linear != 0.0:
            way, verdict = ("forward", forward) if linear > 0.0 else ("backward", backward)
            if verdict.allowed == 0.0:
                # Nothing is left of the curve: the rotation is judged alone, and passes slowly. Never a trap.
                linear = 0.0
                angular = math.copysign(min(abs(angular), self._config.creep_angular), angular)
                limit = f"{way} blocked: {verdict.reason}; {verdict.way_out}"
            elif verdict.allowed < abs(linear):
                share = verdict.allowed / abs(linear)  # of both: the curvature is the operator's
                linear, angular = linear * share, angular * share
                limit = f"{way} slowed: {verdict.reason or f'this robot drives at {verdict.allowed:g} m/s at most'}"
        return linear, angular, limit

    def _turn(self, asked: DriveCommand | None, forward: Verdict, backward: Verdict) -> Verdict:
        """Turning in place sweeps nothing beyond the footprint's disc, so it needs no sensor."""
        free = Verdict(allowed=self._robot.max_angular_speed, freedom="free", sensor="", reason="", way_out="")
        if asked is None or asked.linear_x == 0.0:
            return free
        ahead = forward if asked.linear_x > 0.0 else backward
        if ahead.allowed > 0.0:
            return free
        return msgspec.structs.replace(
            free,
            allowed=self._config.creep_angular,
            freedom="creep",
            sensor=ahead.sensor,
            reason=ahead.reason,
            way_out="hold no forward or backward tilt to turn faster",
        )
