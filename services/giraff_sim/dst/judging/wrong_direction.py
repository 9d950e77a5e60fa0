"""Whether the robot goes where its operator's hand does not point: truly, by the speed of its wheels."""

from __future__ import annotations

from typing import Final

from giraff_sim.dst.judging.true_input import PointedDirection
from giraff_sim.world.body import Body

_WRONG: Final = 0.05  # m/s of the centre, or of each wheel where it turns
_UNASKED: Final = 0.12  # the same of a way that nobody asks for: unlike motors turn a robot that drives, and drive one
_LETS_GO_US: Final = 500_000  # from a level hand to motors without power: its command's budget, a report and a step
_OBEYS_US: Final = 450_000  # within which a wish that has changed is obeyed, or the robot stopped
_LASTS_US: Final = 500_000


class WrongDirection:
    """Asked after each step, with and without power."""

    def __init__(self, body: Body) -> None:
        self._plant, self._acts, self._settles_us = body.plant, body.acts, body.settles_us
        self._asked: tuple[str, PointedDirection] = "", (None, None)
        self._since_us = [0, 0]  # the robot goes the other way, or may still
        self._asks_us = 0  # when the operator may have asked for something last

    def judge(self, operator: str, way: PointedDirection, now_us: int) -> str:
        """How a robot whose motors have power goes against the `way` that `operator` points; empty when it does not."""
        (operator_before, way_before), self._asked = self._asked, (operator, way)
        if way != (0, 0) or operator != operator_before:
            self._asks_us = now_us
        changed = [operator != operator_before or now != before for now, before in zip(way, way_before, strict=True)]
        against = self._against(way, changed, now_us)
        if now_us - self._asks_us > _LETS_GO_US + self._settles_us:
            return f"{self._acts} {(now_us - self._asks_us) / 1e6:.3f} s after {operator} has let go"
        return f"{against}, where {operator} points elsewhere" if against else ""

    def _against(self, way: PointedDirection, changed: list[bool], now_us: int) -> str:
        plant = self._plant
        speeds = plant.speed, (plant.right.speed - plant.left.speed) / 2.0
        against = ""
        for axis, (name, asked, speed) in enumerate(zip(("linear", "turning"), way, speeds, strict=True)):
            if changed[axis]:
                self._since_us[axis] = now_us + _OBEYS_US + self._settles_us
            elif asked is None or (asked * speed >= -_WRONG if asked else abs(speed) <= _UNASKED):
                self._since_us[axis] = max(self._since_us[axis], now_us)
            if now_us - self._since_us[axis] > _LASTS_US:
                against = f"{name} at {speed:+.2f} m/s for {_LASTS_US / 1e6:g} s"
        return against
