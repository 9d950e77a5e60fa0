"""Faults that must stop the robot, each within its bound."""

from collections.abc import Callable
from typing import Final, NamedTuple

from giraff_sim.world.body import Body, BoundedMotion

ROBOT_US: Final = 350_000
"""Of a fault on the robot's side."""
BEYOND_US: Final = 450_000
"""Of a fault of the operator's side, of the link or of the ranger."""
TWO_US: Final = 550_000
"""Of two at once."""

_STEPS_US: Final = 8_000  # of the simulation, at both ends


class Stop(NamedTuple):
    """What must stop, and since when."""

    what: str
    since_us: int
    bound_us: int
    way: BoundedMotion
    applies: Callable[[], bool]
    """Whether it stops the robot now: one operator's fault does not while another one drives."""


class Stops:
    """Those in force, and whether one is overdue."""

    def __init__(self, body: Body, goes: Callable[[BoundedMotion], bool]) -> None:
        """`goes`: says whether the robot is driven that way."""
        self._acts = body.acts
        self._late_us = body.settles_us + _STEPS_US
        self._goes = goes
        self._stops: list[Stop] = []
        self._changed_us = -TWO_US  # when one that applied ended

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
        """A stop that should have happened, with the robot not in its safe state now; empty when none is."""
        for stop in self._stops:
            due_us = stop.since_us + stop.bound_us + self._late_us
            if now_us <= due_us or not stop.applies() or not self._goes(stop.way):
                continue
            if now_us > self._due_beside_others_us(stop):
                return f"{self._acts} {(now_us - stop.since_us) / 1e6:.3f} s after: {stop.what}"
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
        return due_us + self._late_us
