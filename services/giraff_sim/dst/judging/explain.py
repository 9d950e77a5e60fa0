"""Whether something true explains a drive frame: a fresh command of the one who may, on fresh ranges."""

from collections.abc import Iterable

from giraff_base.config import BaseConfig
from giraff_core.robot import RobotConfig
from giraff_core.senses import Ultrasonic
from giraff_sim.dst.judging.ledger import Ledger, Passed
from giraff_sim.dst.judging.sensors import looks_along
from giraff_sim.world.body import Demand


class Explainer:
    """Judges by the ledger alone."""

    def __init__(self, ledger: Ledger, robot: RobotConfig, config: BaseConfig) -> None:
        self._ledger = ledger
        self._sensors = robot.of(Ultrasonic)
        self._operator_us = round(config.operator_budget * 1e6)
        self._guard_us = round(config.guard_budget * 1e6)
        self._range_us = round(config.range_budget * 1e6)

    def why_not(self, asked: Demand, heard: Iterable[Passed], now_us: int) -> tuple[str, Passed | None]:
        """What is wrong with the best explanation, after its rule's letter; and the explanation, if it is one."""
        closest = "b: base was handed no command for this"
        rank = 0
        for passed in heard:
            if not asked.is_within(passed.command.linear_x, passed.command.angular_z):
                continue
            step, wrong = self._wrong(asked, passed, now_us)
            if not wrong:
                return "", passed
            if step > rank:
                rank, closest = step, wrong
        return closest, None

    def _wrong(self, asked: Demand, passed: Passed, now_us: int) -> tuple[int, str]:
        """How far the explanation holds, and what is wrong with it then; empty when nothing is."""
        command, given = passed.command, passed.given
        old = now_us - passed.at_us
        if old > self._guard_us:
            return 1, f"b: the guard's command is {old / 1e6:.3f} s old"
        if given is None:
            return 2, "c: the guard had not heard the operator it names"
        if not self._was_granted(passed):
            return 3, f"c: {command.operator} did not hold the lease {command.lease_counter}"
        if given.command.source != "hand":
            return 4, f"c: {command.operator} told of a fault: {given.command.reason}"
        if not asked.is_within(given.command.linear_x, given.command.angular_z):
            return 5, f"c: {command.operator} asks for something else"
        old = now_us - given.born_us
        if old > self._operator_us:
            return 6, f"b: the command of {command.operator} is {old / 1e6:.3f} s old"
        return 7, self._stale_range(asked, passed, now_us)

    def _was_granted(self, passed: Passed) -> bool:
        command, given = passed.command, passed.given
        grants = self._ledger.leases[command.instance]
        then = next((grant for grant in reversed(grants) if grant.at_us <= passed.at_us), None)
        return (
            then is not None
            and given is not None
            and then.holder == command.operator
            and then.counter == command.lease_counter == given.command.lease_counter
        )

    def _stale_range(self, asked: Demand, passed: Passed, now_us: int) -> str:
        if not asked.goes:
            return ""
        for name, pose in self._sensors.items():
            if not looks_along(pose, asked.linear):
                continue
            if name not in passed.ranges:
                return f"b: {name} had never been heard"
            old = now_us - passed.ranges[name][1]
            if old > self._range_us:
                return f"b: the ping of {name} is {old / 1e6:.3f} s old"
        return ""
