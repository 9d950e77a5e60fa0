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
_CREEPING: Final = 0.02  # m/s

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

    def __init__(self, simulation: Simulation, *, by_speed: bool = False) -> None:
        """`by_speed`: the board holds speeds, and gives unlike motors unlike power to turn in place."""
        self._simulation = simulation
        self._by_speed = by_speed
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
            due_us = stop.since_us + stop.bound_us + _STEPS_US
            if now_us <= due_us or not stop.applies() or not self._goes(stop.way):
                continue
            if now_us > self._due_beside_others_us(stop):
                return f"power {(now_us - stop.since_us) / 1e6:.3f} s after: {stop.what}"
        return ""

    def _due_beside_others_us(self, stop: Stop) -> int:
        """When a stop is due if others befell the robot before it was: of two at once within `TWO_US`.

        One of the robot's side that came later may have cut off the layer that was about to stop it: what lies below
        has that one's own bound, from its own beginning.
        """
        due_us = stop.since_us + stop.bound_us
        others = [other for other in self._stops if other is not stop and other.applies() and other.since_us <= due_us]
        if others or self._changed_us >= stop.since_us:
            due_us = stop.since_us + TWO_US
        for other in others:
            if other.bound_us <= ROBOT_US:
                due_us = max(due_us, other.since_us + other.bound_us)
        return due_us + _STEPS_US

    def _goes(self, way: Way) -> bool:
        if way == "any":
            return True
        motors = self._simulation.boards[BoardKind.BASE].model.motor
        counts = motors[0].drive + motors[1].drive
        speed = self._simulation.world.plant.speed
        if self._by_speed and not (abs(speed) > _CREEPING and counts * speed > 0.0):
            return False  # no power keeps the middle going: it turns, or what it had is slowed down
        if way == "forward":
            return bool(counts > _CREEPING_COUNTS)
        if way == "backward":
            return bool(counts < -_CREEPING_COUNTS)
        return bool(abs(counts) > _CREEPING_COUNTS)
