"""Who drives: hands that tilt the joystick and fingers on the keyboard, from a seed."""

from __future__ import annotations

import bisect
import math
import random
from typing import Final

from giraff_sim.bno055 import GRAVITY, Vector
from giraff_sim.room import Pose

_MUSCLE: Final = 0.12  # s, time constant of the wrist
_ARMS_AFTER: Final = 1.2  # s of rest at the beginning: board, sensor and services start meanwhile


class RestlessHand:
    """Tilts any way for some seconds, rests, and goes on: what no room suggests, but every rule must stand."""

    trembles = True

    def __init__(self, chance: random.Random, seconds: float) -> None:
        self._times: list[float] = [0.0]
        self._tilts: list[tuple[float, float]] = [(0.0, 0.0)]
        moment = _ARMS_AFTER + chance.uniform(0.0, 1.0)
        while moment < seconds:
            self._add(moment, _tilt(chance))
            moment += chance.uniform(0.4, 3.5)
            if chance.random() < 0.7:
                self._add(moment, (0.0, 0.0))
                moment += chance.uniform(0.15, 1.2)
        self._forward = self._left = 0.0
        self._seen = 0.0

    def acceleration(self, seconds: float, robot: Pose) -> Vector:
        del robot
        forward, left = self._tilts[bisect.bisect_right(self._times, seconds) - 1]
        share = 1.0 - math.exp(-(seconds - self._seen) / _MUSCLE)
        self._seen = seconds
        self._forward += (forward - self._forward) * share
        self._left += (left - self._left) * share
        x, y = GRAVITY * math.sin(self._forward), GRAVITY * math.sin(self._left) * math.cos(self._forward)
        return x, y, math.sqrt(max(0.0, GRAVITY**2 - x * x - y * y))

    def _add(self, moment: float, tilt: tuple[float, float]) -> None:
        self._times.append(moment)
        self._tilts.append(tilt)


def _tilt(chance: random.Random) -> tuple[float, float]:
    """Forward and to the left, radians."""
    forward = math.radians(chance.choice((1.0, 1.0, 1.0, -1.0, 0.0)) * chance.uniform(12.0, 45.0))
    left = math.radians(chance.choice((0.0, 1.0, -1.0)) * chance.uniform(0.0, 35.0))
    return forward, left


class Fingers:
    """Hold keys of a keyboard down, each for a while: after the first press it repeats, 30 times a second."""

    def __init__(self, chance: random.Random, begin: float, seconds: float) -> None:
        """Type from `begin` to `seconds`, simulated s."""
        self._presses: list[tuple[float, bytes]] = []
        moment = begin + chance.uniform(0.0, 1.0)
        while moment < seconds:
            key = chance.choice((b"w", b"w", b"s", b"a", b"d", b"c"))
            until = moment + chance.uniform(0.1, 3.0)
            self._presses.append((moment, key))
            repeat = moment + _REPEATS_AFTER
            while repeat < until:
                self._presses.append((repeat, key))
                repeat += _REPEATS_EVERY
            moment = until + chance.uniform(0.1, 1.5)
        self._next = 0

    def pressed(self, now: float) -> bytes:
        """The next press, once it is due at `now`, simulated s; empty until then."""
        if self._next == len(self._presses) or self._presses[self._next][0] > now:
            return b""
        self._next += 1
        return self._presses[self._next - 1][1]

    def wait(self, now: float) -> float | None:
        """s until the next press; None when there is none."""
        return None if self._next == len(self._presses) else max(0.0, self._presses[self._next][0] - now)


_REPEATS_AFTER: Final = 0.35  # s
_REPEATS_EVERY: Final = 1.0 / 30.0  # s
