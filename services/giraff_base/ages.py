"""How old everything is that a command stands on."""

from __future__ import annotations

from typing import Final, NamedTuple

from giraff_base.config import BaseConfig
from giraff_core.freshness import age, derate
from giraff_schemas.messages import GuardedCommand, RobotTime
from giraff_schemas.trouble import Trouble

_LATE_GUARD: Final = Trouble("the guard's commands come late", "relieve this machine")
_LATE_OPERATOR: Final = Trouble("the operator's commands come late", "check its link")


class Ages(NamedTuple):
    """s; infinite where nothing is proven."""

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
    """Of the operator's, the guard's and the range's tick."""
    return Ages(
        operator=age(command.operator_tick, now),
        guard=age(command.guard_tick, now),
        ranged=age(command.range_tick, now) if command.range_tick is not None else 0.0,
    )
