"""When the robot may move at all: whether the holder's neutral hand has armed it."""

from giraff_base.config import BaseConfig
from giraff_core.freshness import age
from giraff_core.live import Live
from giraff_schemas.messages import GuardedCommand, RobotTime
from giraff_schemas.trouble import NO_TROUBLE, Trouble


class Arming:
    """Lets only a held neutral hand arm.

    A reset of whatever kind permits motion and never causes it: each one disarms, and only the operator's own
    neutral arms again, measured by the ticks of his hand and not by when they arrived.
    """

    def __init__(self, live: Live[BaseConfig]) -> None:
        self._live = live
        self.armed = False
        self._why = Trouble("base has just started")  # what disarmed last
        self._holder = ("", 0)
        self._faults = 0
        self._since: RobotTime | None = None  # when the first command after the disarming came
        self._neutral_from: RobotTime | None = None
        self._neutral_to: RobotTime | None = None

    @property
    def refusal(self) -> Trouble:
        """Why the robot is not armed, and how to arm it."""
        if self.armed:
            return NO_TROUBLE
        what = f"not armed since {self._why.what}"
        return Trouble(what, self._why.remedy, "hold_level", f"{self._live.config.arm_time:g} s")

    def disarm(self, why: str, remedy: str = "") -> None:
        """Disarm the robot. `remedy`: what to do before it is armed again."""
        if self.armed:
            self._why = Trouble(why, remedy)
        self.armed = False
        self._since = self._neutral_from = self._neutral_to = None

    def consider(self, command: GuardedCommand, now: RobotTime) -> None:
        """Arm or disarm by what the holder of the lease does. `command` was admitted."""
        holder = (command.operator, command.lease_counter)
        if holder != self._holder:
            self.disarm("another operator took over" if command.operator != self._holder[0] else "a new lease")
            self._holder = holder
        if command.faults != self._faults:
            self.disarm("the operator's side was at fault")
            self._faults = command.faults
        if command.source == "fault":
            self.disarm("the operator's side reports a fault")
        elif command.lease_counter == 0:
            self.disarm("nobody holds the lease")
        elif self._held(command, now) >= self._live.config.arm_time:
            self.armed = True

    def _held(self, command: GuardedCommand, now: RobotTime) -> float:
        """s for which the hand has been neutral, in the hand's own time; negative while it is not."""
        tick = command.operator_tick
        self._since = self._since or now
        is_neutral = command.hand_neutral and command.neutral
        if tick is None or age(tick, now) > self._live.config.operator_budget or not is_neutral:
            self._neutral_from = self._neutral_to = None
            return -1.0
        if tick.robot_ns < self._since.robot_ns:
            return -1.0  # of before the disarming: the hand may be elsewhere since
        # Two moments far apart, or in the wrong order, are not a hand that was held.
        if age(self._neutral_to, tick) > self._live.config.neutral_gap:
            self._neutral_from = tick
        self._neutral_to = tick
        return age(self._neutral_from, tick)
