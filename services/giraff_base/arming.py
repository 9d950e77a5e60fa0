"""When the robot may move at all: whose commands count, and whether a neutral hand has armed it."""

from __future__ import annotations

from giraff_base.config import BaseConfig
from giraff_node.freshness import age
from giraff_schemas.messages import GuardedCommand, RobotTime

HOW_TO_ARM = "hold the hand level"


class Arming:
    """Binds base to one guard, and lets only a held neutral hand arm.

    A reset of whatever kind permits motion and never causes it: each one disarms, and only the operator's own
    neutral arms again, measured by the ticks of his hand and not by when they arrived.
    """

    def __init__(self, config: BaseConfig) -> None:
        self._config = config
        self.armed = False
        self.guard = ""
        """Instance of the guard in charge; empty: none yet."""
        self.why = "base has just started"
        """What disarmed last."""
        self.intruder = ""
        """A second guard that was heard lately while the one in charge was alive; empty: none."""
        self._intruder_heard_ns = 0
        self._guard_heard_ns = 0
        self._last_seq = -1
        self._operator = ""
        self._neutral_from: RobotTime | None = None
        self._neutral_to: RobotTime | None = None

    def disarm(self, why: str) -> None:
        if self.armed:
            self.why = why
        self.armed = False
        self._neutral_from = self._neutral_to = None

    def admit(self, command: GuardedCommand, now: RobotTime, at_rest: bool) -> str:
        """Judge a command by who sent it and when; empty when it counts, else why it does not."""
        too_old = "the guard's command is too old" if age(command.guard_tick, now) > self._config.guard_budget else ""
        if command.instance != self.guard:
            silent = (now.robot_ns - self._guard_heard_ns) * 1e-9
            if self.guard:
                self.disarm(f"guard {command.instance} spoke while base obeys guard {self.guard}")
                if silent < self._config.guard_silence:
                    self.intruder, self._intruder_heard_ns = command.instance, now.robot_ns
                    return f"a second guard, {command.instance}, is running; end one of the two"
                if not at_rest:
                    return "a new guard waits until the robot is at rest"
            if too_old:
                return too_old
            self.guard, self.intruder, self._last_seq = command.instance, "", -1
        if command.seq <= self._last_seq:
            return f"command {command.seq} is not newer than {self._last_seq}"
        self._last_seq = command.seq
        self._guard_heard_ns = now.robot_ns
        if (now.robot_ns - self._intruder_heard_ns) * 1e-9 >= self._config.guard_silence:
            self.intruder = ""
        return too_old

    def consider(self, command: GuardedCommand, now: RobotTime) -> None:
        """Arm or disarm by what the hand does. `command` was admitted."""
        if command.operator != self._operator:
            self._operator = command.operator
            self.disarm("another operator")
        if command.source == "fault":
            self.disarm("the operator's side reports a fault")
            return
        tick = command.operator_tick
        neutral = command.hand_neutral and command.neutral
        if tick is None or age(tick, now) > self._config.operator_budget or not neutral:
            self._neutral_from = self._neutral_to = None
            return
        if self._neutral_to is None or age(self._neutral_to, now) > self._config.operator_budget:
            self._neutral_from = tick
        self._neutral_to = tick
        held_ns = tick.robot_ns - self._neutral_from.robot_ns if self._neutral_from else 0
        if held_ns >= self._config.arm_time * 1e9:
            self.armed = True
