"""Whom base obeys: one guard process, and no copy, replay or double of it."""

from __future__ import annotations

from giraff_base.arming import Arming
from giraff_base.config import BaseConfig
from giraff_core.freshness import age
from giraff_core.live import Live
from giraff_schemas.messages import GuardedCommand, RobotTime


class Binding:
    """Binds base to one guard. A stale sample, of whichever guard, changes nothing: its maker may be long gone."""

    def __init__(self, live: Live[BaseConfig], arming: Arming) -> None:
        self._live = live
        self._arming = arming
        self.guard = ""
        """Instance of the guard in charge; empty: none yet."""
        self._heard_ns = 0
        self._last_seq = -1
        self._intruder = ""
        self._intruder_heard_ns = 0

    @property
    def intruder(self) -> str:
        """Another guard was heard lately while the one in charge was alive; empty: none was."""
        return f"a second guard, {self._intruder}, is running; end one of the two" if self._intruder else ""

    def admit(self, command: GuardedCommand, now: RobotTime, at_rest: bool) -> str:
        """Judge a command by who sent it and when; empty when it counts, else why it does not."""
        if age(command.guard_tick, now) > self._live.config.guard_budget:
            return "the guard's command is too old"
        if command.instance != self.guard:
            if refusal := self._replace(command.instance, now, at_rest):
                return refusal
        elif command.seq <= self._last_seq:
            return f"command {command.seq} is not newer than {self._last_seq}"
        self._last_seq = command.seq
        self._heard_ns = now.robot_ns
        return ""

    def forget(self, now: RobotTime) -> None:
        """Name a second guard no longer once it has been silent."""
        if (now.robot_ns - self._intruder_heard_ns) * 1e-9 >= self._live.config.guard_silence:
            self._intruder = ""

    def _replace(self, instance: str, now: RobotTime, at_rest: bool) -> str:
        """Another guard lives: why it is not bound, or empty when it is from now on."""
        if self.guard:
            self._arming.disarm(f"guard {instance} spoke while base obeyed guard {self.guard}")
            if (now.robot_ns - self._heard_ns) * 1e-9 < self._live.config.guard_silence:
                self._intruder, self._intruder_heard_ns = instance, now.robot_ns
                return self.intruder
            self._intruder = ""  # the one that was in charge has gone
            if not at_rest:
                return "a new guard waits until the robot is at rest"
        self.guard = instance
        return ""
