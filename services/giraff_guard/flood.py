"""Whose commands flood the guard. They change no bound, and take the processor that others need."""

from collections import Counter
from typing import Final

from giraff_schemas.messages import DriveCommand
from giraff_schemas.topics import OPERATOR_CMD_VEL
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_MOST: Final = 250
"""Commands a second of all operators, whatever they are: three hands beside keys that are held."""
_SECOND_NS: Final = 1_000_000_000
_LASTS: Final = 2
"""Seconds in a row; one may be what a link that was cut has held, and hands over."""


class FloodWatch:
    """Counts the commands of each second by who gave them."""

    def __init__(self) -> None:
        self._counts: Counter[str] = Counter()  # by operator: a program may call itself another instance each time
        self._since_ns = 0
        self._in_a_row = 0
        self._told = NO_TROUBLE

    def count(self, command: DriveCommand, robot_ns: int) -> None:
        """One has come."""
        self.judge(robot_ns)
        self._counts[command.operator] += 1

    def judge(self, robot_ns: int) -> Trouble:
        """Whose flood it is, by the last whole seconds."""
        if robot_ns - self._since_ns >= _SECOND_NS:
            is_flood = self._counts.total() > _MOST and robot_ns - self._since_ns < 2 * _SECOND_NS
            self._in_a_row = self._in_a_row + 1 if is_flood else 0
            self._told = self._describe() if self._in_a_row >= _LASTS else NO_TROUBLE
            self._counts.clear()
            self._since_ns = robot_ns
        return self._told

    def _describe(self) -> Trouble:
        operator, count = self._counts.most_common(1)[0]
        whose = f"most of them from {operator}" if 2 * count > self._counts.total() else "under many operators' names"
        return Trouble(
            f"more than {_MOST} commands a second come, {whose}; one operator gives {OPERATOR_CMD_VEL.rate_hz:g}",
            "end what gives so many",
        )
