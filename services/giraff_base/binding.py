"""Whom base obeys: one guard process, and no copy, replay or double of it."""

from giraff_base.arming import Arming
from giraff_base.config import BaseConfig
from giraff_core.freshness import age
from giraff_core.live import Live
from giraff_schemas.messages import GuardedCommand, RobotTime
from giraff_schemas.trouble import NO_TROUBLE, Trouble


class GuardBinding:
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
    def intruder(self) -> Trouble:
        """Another guard was heard lately while the one in charge was alive."""
        if not self._intruder:
            return NO_TROUBLE
        return Trouble(f"a second guard, {self._intruder}, is running", "end one of the two")

    def admit(self, command: GuardedCommand, now: RobotTime, at_rest: bool) -> Trouble:
        """Judge a command by who sent it and when: why it does not count."""
        if age(command.guard_tick, now) > self._live.config.guard_budget:
            return Trouble("the guard's command is too old")
        if command.instance != self.guard:
            if refusal := self._replace(command.instance, now, at_rest):
                return refusal
        elif command.seq <= self._last_seq:
            return Trouble(f"command {command.seq} is not newer than {self._last_seq}")
        self._last_seq = command.seq
        self._heard_ns = now.robot_ns
        return NO_TROUBLE

    def forget(self, now: RobotTime) -> None:
        """Name a second guard no longer once it has been silent."""
        if (now.robot_ns - self._intruder_heard_ns) * 1e-9 >= self._live.config.guard_silence:
            self._intruder = ""

    def _replace(self, instance: str, now: RobotTime, at_rest: bool) -> Trouble:
        """Another guard lives: why it is not bound. NO_TROUBLE: it is from now on."""
        if self.guard:
            self._arming.disarm(f"guard {instance} spoke while base obeyed guard {self.guard}")
            if (now.robot_ns - self._heard_ns) * 1e-9 < self._live.config.guard_silence:
                self._intruder, self._intruder_heard_ns = instance, now.robot_ns
                return self.intruder
            self._intruder = ""  # the one that was in charge has gone
            if not at_rest:
                return Trouble("a new guard waits until the robot is at rest")
        self.guard = instance
        return NO_TROUBLE
