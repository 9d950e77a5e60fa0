"""Faults that must stop the robot, each within its bound."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final, Literal, NamedTuple

from giraff_schemas.wire import BoardKind
from giraff_sim.simulation import Simulation

ROBOT_US: Final = 350_000
"""Of a fault on the robot's side."""
BEYOND_US: Final = 450_000
"""Of a fault of the operator's side, of the link or of the ranger."""
TWO_US: Final = 550_000
"""Of two at once."""

_STEPS_US: Final = 8_000  # of the simulation, at both ends
_CREEPING_COUNTS: Final = 4  # of both motors: less is what rounding leaves of a turn in place

Way = Literal["any", "travel", "forward", "backward"]


class Stop(NamedTuple):
    """What must stop, and since when."""

    what: str
    since_us: int
    bound_us: int
    way: Way
    """Motion that it stops; turning in place is no travel."""
    applies: Callable[[], bool]
    """Whether it stops the robot now: one operator's fault does not while another one drives."""


class Stops:
    """Those in force, and whether one is overdue."""

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation
        self._stops: list[Stop] = []
        self._changed_us = -TWO_US  # when one that applied ended

    @property
    def any_in_force(self) -> bool:
        return bool(self._stops)

    def begin(self, stop: Stop) -> None:
        self._stops.append(stop)

    def end(self, what: str, now_us: int) -> None:
        """End the oldest stop of that name."""
        for stop in self._stops:
            if stop.what == what:
                self._stops.remove(stop)
                self._changed_us = now_us
                return

    def overdue(self, now_us: int) -> str:
        """A stop that should have happened, with the motors now under power; empty when none is."""
        for stop in self._stops:
            passed_us = now_us - stop.since_us - _STEPS_US
            if passed_us <= stop.bound_us or not stop.applies() or not self._goes(stop.way):
                continue
            if passed_us > TWO_US or not self._is_one_of_two(stop):
                return f"power {passed_us / 1e6:.3f} s after: {stop.what}"
        return ""

    def _is_one_of_two(self, stop: Stop) -> bool:
        if self._changed_us >= stop.since_us:
            return True
        return any(other is not stop and other.applies() for other in self._stops)

    def _goes(self, way: Way) -> bool:
        if way == "any":
            return True
        motors = self._simulation.boards[BoardKind.BASE].model.motor
        counts = motors[0].drive + motors[1].drive
        if way == "forward":
            return bool(counts > _CREEPING_COUNTS)
        if way == "backward":
            return bool(counts < -_CREEPING_COUNTS)
        return bool(abs(counts) > _CREEPING_COUNTS)
