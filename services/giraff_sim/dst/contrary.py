"""Whether the robot goes where its operator's hand does not point: truly, by the speed of its wheels."""

from __future__ import annotations

from typing import Final

from giraff_sim.dst.wishes import Way
from giraff_sim.plant import Plant

_CONTRARY: Final = 0.05  # m/s of the centre, or of each wheel where it turns
_UNASKED: Final = 0.12  # the same of a way that nobody asks for: unlike motors turn a robot that drives, and drive one
_LETS_GO_US: Final = 500_000  # from a level hand to motors without power: its command's budget, a report and a step
_OBEYS_US: Final = 450_000  # within which a wish that has changed is obeyed, or the robot stopped
_LASTS_US: Final = 500_000


class Contrary:
    """Asked after each step, once in a while without power too."""

    def __init__(self, plant: Plant) -> None:
        self._plant = plant
        self._asked: tuple[str, Way] = "", (None, None)
        self._since_us = [0, 0]  # the robot goes the other way, or may still
        self._asks_us = 0  # when the operator may have asked for something last

    def look(self, operator: str, way: Way, now_us: int) -> str:
        """How it goes against the `way` that `operator` points; empty when it does not."""
        if way != (0, 0) or operator != self._asked[0]:
            self._asks_us = now_us
        elif now_us - self._asks_us > _LETS_GO_US:
            return f"power {(now_us - self._asks_us) / 1e6:.3f} s after {operator} has let go"
        plant = self._plant
        speeds = plant.speed, (plant.right.speed - plant.left.speed) / 2.0
        for axis, (name, asked, speed) in enumerate(zip(("linear", "turning"), way, speeds, strict=True)):
            has_changed = operator != self._asked[0] or asked != self._asked[1][axis]
            if has_changed:
                self._since_us[axis] = now_us + _OBEYS_US
            elif asked is None or (asked * speed >= -_CONTRARY if asked else abs(speed) <= _UNASKED):
                self._since_us[axis] = max(self._since_us[axis], now_us)
            if now_us - self._since_us[axis] > _LASTS_US:
                return f"{name} at {speed:+.2f} m/s for {_LASTS_US / 1e6:g} s, where {operator} asks for {asked}"
        self._asked = operator, way
        return ""
