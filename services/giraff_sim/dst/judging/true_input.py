"""What the operators' hands truly do, whatever a sensor, a board or a service makes of it, and whether the robot goes
where they do not point.

A hand that holds the joystick is judged by the acceleration that truly acts on it and by the button, fingers by the
keys they press.
"""

import math
from collections import defaultdict, deque
from itertools import takewhile
from typing import Final, NamedTuple

from giraff_joystick.config import JoystickConfig
from giraff_sim.world.bno055 import GRAVITY, Vector
from giraff_sim.world.body import Body

_KEPT_US: Final = 2_000_000
_PRESS_US: Final = 400_000  # that one press asks for
_SAME_US: Final = 30_000  # a reading's age within its board: what the hand did just before counts for it too
_DOUBT_DEG: Final = 1.0
_KEYS: Final = {ord("w"): (1, 0), ord("s"): (-1, 0), ord("a"): (0, 1), ord("d"): (0, -1)}
_WRONG: Final = 0.05  # m/s of the centre, or of each wheel where it turns
_UNASKED: Final = 0.12  # the same of a way that nobody asks for: unlike motors turn a robot that drives, and drive one
_LETS_GO_US: Final = 500_000  # from a level hand to motors without power: its command's budget, a report and a step
_OBEYS_US: Final = 450_000  # within which a wish that has changed is obeyed, or the robot stopped
_LASTS_US: Final = 500_000

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


class WrongDirection:
    """Judges whether the robot goes where its operator's hand does not point, by the true speed of its wheels.

    It is asked after each step, with and without power.
    """

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
