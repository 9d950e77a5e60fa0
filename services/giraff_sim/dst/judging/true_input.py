"""What the operators' hands truly do, whatever a sensor, a board or a service makes of it.

A hand that holds the joystick is judged by the acceleration that truly acts on it and by the button, fingers by the
keys they press.
"""

from __future__ import annotations

import math
from collections import defaultdict, deque
from itertools import takewhile
from typing import Final, NamedTuple

from giraff_joystick.config import JoystickConfig
from giraff_sim.world.bno055 import GRAVITY, Vector

_KEPT_US: Final = 2_000_000
_PRESS_US: Final = 400_000  # that one press asks for
_SAME_US: Final = 30_000  # a reading's age within its board: what the hand did just before counts for it too
_DOUBT_DEG: Final = 1.0
_KEYS: Final = {ord("w"): (1, 0), ord("s"): (-1, 0), ord("a"): (0, 1), ord("d"): (0, -1)}

PointedDirection = tuple[int | None, int | None]
"""Sign of the way that a hand asks for, forward and left; 0: surely neither, None: one cannot tell."""


class _Held(NamedTuple):
    """How a joystick is held from a moment on."""

    at_us: int
    neutral: bool
    way: PointedDirection


class TrueInput:
    """Of each operator, by its process's instance."""

    def __init__(self, config: JoystickConfig, offset: Vector) -> None:
        """`offset`: m/s² that the sensor reads too much: a level hand may be that far off for it."""
        self._zone = config.dead_zone_deg
        self._off = [math.degrees(math.asin(abs(axis) / GRAVITY)) for axis in offset[:2]]
        self._held: dict[str, deque[_Held]] = defaultdict(deque)
        self._pressed: dict[str, deque[tuple[int, PointedDirection]]] = defaultdict(deque)

    def hold(self, instance: str, acceleration: Vector, now_us: int) -> None:
        """A joystick is held so that this truly acts on it (m/s²)."""
        x, y, z = acceleration
        angles = math.degrees(math.atan2(x, math.hypot(y, z))), math.degrees(math.atan2(y, math.hypot(x, z)))
        ways = [self._sign(angle, off + _DOUBT_DEG) for angle, off in zip(angles, self._off, strict=True)]
        self._note(instance, _Held(now_us, neutral=all(way in (0, None) for way in ways), way=(ways[0], ways[1])))

    def clutch(self, instance: str, now_us: int) -> None:
        """The button of a joystick is pressed: however it is held, nothing is asked for."""
        self._note(instance, _Held(now_us, neutral=True, way=(0, 0)))

    def _note(self, instance: str, newest: _Held) -> None:
        held = self._held[instance]
        held.append(newest)
        while newest.at_us - held[0].at_us > _KEPT_US:
            held.popleft()

    def _sign(self, angle: float, doubt: float) -> int | None:
        """Of an angle in degrees that may be read `doubt` too large or too small."""
        if abs(angle) > self._zone + doubt:
            return int(math.copysign(1.0, angle))
        return 0 if abs(angle) < self._zone - doubt else None

    def press(self, instance: str, keys: bytes, now_us: int) -> None:
        """Keys of a keyboard are pressed."""
        self._pressed[instance].extend((now_us, _KEYS[key]) for key in keys if key in _KEYS)

    def is_neutral(self, instance: str, us: int) -> bool:
        """Whether the hand asked for nothing then, or just before."""
        # The newest first: what is asked for lies a few readings back, and most of what is kept lies before that.
        if instance in self._held:
            then = takewhile(lambda held: us - held.at_us <= _SAME_US, reversed(self._held[instance]))
            return any(held.neutral for held in then if held.at_us <= us)
        pressed = takewhile(lambda press: us - press[0] < _PRESS_US, reversed(self._pressed[instance]))
        return all(at_us > us for at_us, _ in pressed)

    def way(self, instance: str, now_us: int) -> PointedDirection:
        """Which way the hand asks to go now."""
        if instance in self._held:
            return self._held[instance][-1].way
        pressed = self._pressed[instance]
        return pressed[-1][1] if pressed and now_us - pressed[-1][0] < _PRESS_US else (0, 0)
