"""Who drives: hands that tilt the joystick and fingers on the keyboard, from a seed."""

import bisect
import math
import random
from typing import Final

from giraff_sim.world.bno055 import GRAVITY, Vector
from giraff_sim.world.hand import Hand
from giraff_sim.world.room import Pose

_MUSCLE: Final = 0.12  # s, time constant of the wrist
_PRESSES_FROM: Final = 2.5  # s; the robot drives by then
_PRESSED: Final = (1.2, 3.0)  # s
_LEVEL: Final = 0.4  # s before and after the button is let go: twice what its service takes for a hand that is still
_LEVELS: Final = 0.3  # s that it takes to come level, and to tilt again
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


class ClutchingHand:
    """Lets another hand drive and presses the button now and then, tilts on, and lets it go while truly level.

    So the attitude that becomes the new zero is level, too: what the hand asks for is what it was.
    """

    def __init__(self, hand: Hand, chance: random.Random, seconds: float) -> None:
        self.trembles = hand.trembles
        self.presses: list[tuple[float, float]] = []
        """When the button is pressed and let go, simulated s."""
        self._hand = hand
        moment = _PRESSES_FROM + chance.uniform(0.0, 6.0)
        while moment < seconds:
            until = moment + chance.uniform(*_PRESSED)
            self.presses.append((moment, until))
            moment = until + chance.uniform(2.0, 8.0)

    def acceleration(self, seconds: float, robot: Pose) -> Vector:
        vector = self._hand.acceleration(seconds, robot)
        share = min((abs(seconds - until) - _LEVEL for _, until in self.presses), default=_LEVELS) / _LEVELS
        if share >= 1.0:
            return vector
        x, y = vector[0] * max(0.0, share), vector[1] * max(0.0, share)
        return x, y, math.sqrt(GRAVITY**2 - x * x - y * y)


class Fingers:
    """Hold keys of a keyboard down, each for a while: after the first press it repeats, 30 times a second.

    Some press the space bar once, the emergency stop, and go on typing.
    """

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
        self.stops = chance.random() < _STOPS  # drawn last: what else is typed stays what it was
        """The space bar is among the keys."""
        if self.stops:
            bisect.insort(self._presses, (begin + chance.uniform(*_STOPS_AFTER), b" "))
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


_STOPS: Final = 0.4  # share of those who type
_STOPS_AFTER: Final = (0.5, 6.0)  # s
_REPEATS_AFTER: Final = 0.35  # s
_REPEATS_EVERY: Final = 1.0 / 30.0  # s
