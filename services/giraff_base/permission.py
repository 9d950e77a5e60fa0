"""Decides what may be driven now: the command in charge, where nothing forbids it, else the first cause why not."""

from typing import Final, NamedTuple

from giraff_base.arming import Arming
from giraff_base.battery import BatteryWatch
from giraff_base.binding import GuardBinding
from giraff_base.config import BaseConfig
from giraff_base.drive import Drive
from giraff_base.estop import EStopControl
from giraff_core.freshness import age, derate
from giraff_core.live import Live
from giraff_schemas.messages import GuardedCommand, RobotTime, Side
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_LATE_GUARD: Final = Trouble("the guard's commands come late", "relieve this machine")
_LATE_OPERATOR: Final = Trouble("the operator's commands come late", "check its link")

_NO_GUARD: Final = Trouble("the guard is not heard", "start giraff_guard on this machine")
_CLOCK_WENT_BACK: Final = Trouble("the robot's clock went back", "restart giraff_base")
_NO_COMMAND: Final = Trouble("no fresh command of an operator", "check its link")
_OLD_RANGE: Final = Trouble(
    "a range that this motion relies on is too old", "check what reads the sensors, as giraff_ranger does"
)
_OPERATORS_FAULT: Final = Trouble("the operator's side reports a fault")
_NO_HOLDER: Final = Trouble("nobody holds the lease", action="ask")


class Ages(NamedTuple):
    """Ages of the ticks that a command relies on, s. Infinite: nothing is proven."""

    operator: float
    guard: float
    ranged: float
    """0 of a command that relies on no range."""

    def left(self, config: BaseConfig) -> float:
        """s until the first of them is too old; negative: it is."""
        return min(
            config.operator_budget - self.operator,
            config.guard_budget - self.guard,
            config.range_budget - self.ranged,
        )

    def share(self, config: BaseConfig) -> tuple[float, Trouble]:
        """Share of the speed that is left, and whose lateness takes the rest. A range counts whole or not at all."""
        by_operator, by_guard = derate(self.operator, config.operator_budget), derate(self.guard, config.guard_budget)
        if by_guard < by_operator:
            return by_guard, _LATE_GUARD
        return by_operator, _LATE_OPERATOR


def ages_of(command: GuardedCommand, now: RobotTime) -> Ages:
    """Return the ages of the ticks of operator, guard and range."""
    return Ages(
        operator=age(command.operator_tick, now),
        guard=age(command.guard_tick, now),
        ranged=age(command.range_tick, now) if command.range_tick is not None else 0.0,
    )


class Permission:
    """Tells which command counts, whether the robot is armed, and what forbids motion."""

    def __init__(
        self,
        live: Live[BaseConfig],
        estop: EStopControl,
        drive: Drive,
        *,
        battery_was_empty: bool = False,
        lost_parameters: Trouble = NO_TROUBLE,
    ) -> None:
        """`lost_parameters`: a saved limit that may be lost; nothing moves then."""
        self._live = live
        self._drive = drive
        self._estop = estop
        self._unchecked = live.config.drive.unchecked
        self._lost_parameters = lost_parameters
        self.arming = Arming(live)
        self.binding = GuardBinding(live, self.arming)
        self.battery = BatteryWatch(live, was_empty=battery_was_empty)
        self.round_trip: float | None = None
        """s; age of the operator's tick when it was used last."""
        self.budget_left: float | None = None
        """s until the first of the ticks in use is too old."""
        self._command: GuardedCommand | None = None
        self._refused = NO_TROUBLE  # why the newest command of any guard did not count
        self._refused_ns = 0
        self._newest_ns = 0
        self._clock_trusted_ns = 0

    @property
    def faults(self) -> dict[str, Trouble]:
        """What is wrong, by what has it."""
        return {
            "guard": self.binding.intruder,
            "battery": self.battery.warning,
            "wiring": self._unchecked,
            "wheels": self._drive.limit.reason,
        }

    def on_command(self, command: GuardedCommand, now: RobotTime, at_rest: bool) -> bool:
        """Take a command of a guard; whether it counts. `at_rest`: the wheels stand still."""
        self._watch(now)
        if self._command is not None:
            self._disarm_if_stale(ages_of(self._command, now))  # before a fresh one can hide it
        # A refused one does not end the command in charge: a late copy must not be able to stop the robot.
        self._refused = self.binding.admit(command, now, at_rest)
        if self._refused:
            self._refused_ns = now.robot_ns
            return False
        self._command = command
        if not self._forbid(now):
            self.arming.consider(command, now)
        return True

    def wanted(self, now: RobotTime) -> tuple[float, float, Trouble]:
        """Return the twist that may be driven now, and why it is less than the command."""
        self._watch(now)
        command = self._command
        if command is None:
            return 0.0, 0.0, self._forbid(now) or self._refused or _NO_GUARD
        ages = ages_of(command, now)
        self.round_trip = ages.operator if ages.operator < self._live.config.disarm_time else None
        self.budget_left = max(ages.left(self._live.config), -self._live.config.disarm_time)
        self._disarm_if_stale(ages)
        if stopped := self._forbid(now) or self._unfounded(command, ages) or self.arming.refusal:
            return 0.0, 0.0, stopped
        share, late = ages.share(self._live.config)
        if self.battery.share < share:
            share, late = self.battery.share, self.battery.warning
        slowed = late.of("slowed") if share < 1.0 and not command.neutral else NO_TROUBLE
        return command.linear_x * share, command.angular_z * share, command.reason or slowed

    def free_side(self, now: RobotTime) -> Side:
        """Return where the guard in charge sees room to sit down. Its word counts as long as its tick does."""
        command = self._command
        if command is None or age(command.guard_tick, now) > self._live.config.guard_budget:
            return "none"
        return command.free_side

    def _forbid(self, now: RobotTime) -> Trouble:
        """Return why nothing may move, whatever is commanded, and disarm the robot then."""
        clock_went_back = now.robot_ns < self._clock_trusted_ns
        forbidden = (
            self._estop.stops
            or (_CLOCK_WENT_BACK if clock_went_back else NO_TROUBLE)
            or self._unchecked
            or self._lost_parameters
            or self.binding.intruder
            or self._drive.arming_block
        )
        if forbidden:
            self.arming.disarm(forbidden.what)
        return forbidden

    def _unfounded(self, command: GuardedCommand, ages: Ages) -> Trouble:
        """Return why the command in charge moves nothing: it is stale, its hand was lost, or nobody gave it."""
        told = command.reason
        if ages.guard > self._live.config.guard_budget:
            return self._refused or _NO_GUARD
        if ages.operator > self._live.config.operator_budget:
            return told or _NO_COMMAND
        if ages.ranged > self._live.config.range_budget and command.linear_x != 0.0:
            return told or _OLD_RANGE
        if command.source == "fault":
            return told or _OPERATORS_FAULT
        if command.lease_counter == 0:
            return told or _NO_HOLDER
        return NO_TROUBLE

    def _disarm_if_stale(self, ages: Ages) -> None:
        """Disarm when a part of the command in charge has been stale for too long."""
        if max(ages) > self._live.config.disarm_time:
            self.arming.disarm("a command or a range was stale for too long")

    def _watch(self, now: RobotTime) -> None:
        """Forget what is no longer so, and look at the clock.

        One that goes back makes old moments look new: nothing counts until it is well past all that it has shown.
        """
        self.binding.forget(now)
        if (now.robot_ns - self._refused_ns) * 1e-9 >= self._live.config.guard_silence:
            self._refused = NO_TROUBLE
        if now.robot_ns < self._newest_ns:
            self._clock_trusted_ns = self._newest_ns + round(self._live.config.disarm_time * 1e9)
        self._newest_ns = max(self._newest_ns, now.robot_ns)
