"""Whether the robot goes where its operator's hand does not point: truly, by the speed of its wheels."""

from __future__ import annotations

from typing import Final

from giraff_sim.dst.wishes import Way
from giraff_sim.plant import Plant

_CONTRARY: Final = 0.05  # m/s of the centre, or of each wheel where it turns
_OBEYS_US: Final = 450_000  # within which a wish that has changed is obeyed, or the robot stopped
_LASTS_US: Final = 500_000


class Contrary:
    """Asked after each step."""

    def __init__(self, plant: Plant) -> None:
        self._plant = plant
        self._asked: tuple[str, Way] = "", (0, 0)
        self._since_us = [0, 0]  # the robot goes the other way, or may still

    def look(self, operator: str, way: Way, now_us: int) -> str:
        """How it goes against the `way` that `operator` points; empty when it does not."""
        plant = self._plant
        speeds = plant.speed, (plant.right.speed - plant.left.speed) / 2.0
        for axis, (name, asked, speed) in enumerate(zip(("linear", "turning"), way, speeds, strict=True)):
            has_changed = operator != self._asked[0] or asked != self._asked[1][axis]
            if has_changed:
                self._since_us[axis] = now_us + _OBEYS_US
            elif asked * speed >= -_CONTRARY:
                self._since_us[axis] = max(self._since_us[axis], now_us)
            if now_us - self._since_us[axis] > _LASTS_US:
                return f"{name} at {speed:+.2f} m/s for {_LASTS_US / 1e6:g} s, where {operator} asks for {asked:+d}"
        self._asked = operator, way
        return ""
