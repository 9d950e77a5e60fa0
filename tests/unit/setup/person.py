"""Who is led through a calibration, drives and measures; and a robot that does exactly what its file says."""

import math
import re
from collections import Counter
from collections.abc import Callable, Mapping
from typing import Final, NamedTuple, Protocol

import msgspec

from giraff_core.counters import signed32
from giraff_schemas.messages import Wheels
from giraff_setup.wheels.odometry.runs import Geometry
from tests.unit.cli.samples import wheels

GEOMETRY: Final = Geometry(2000.0, 0.5)
_RATE: Final = 10.0  # Hz
_SPEED: Final = 0.3  # m/s
_WRAP: Final = 1 << 32
_PATIENCE: Final = 50
"""Times that a person answers one question."""
_HALF_TRACK: Final = GEOMETRY.track_width / 2.0
_LINE: Final = ((5.0, 5.0),)
_TURN: Final = ((-math.tau * _HALF_TRACK, math.tau * _HALF_TRACK),)
_SIDE: Final = ((2.0, 2.0), (-math.tau * _HALF_TRACK / 4.0, math.tau * _HALF_TRACK / 4.0))


class Pose(NamedTuple):
    """As measured: m, m, degrees."""

    x: float
    y: float
    heading: float


class Body(Protocol):
    """What is driven."""

    def drive(self, leg: str) -> None:
        """This leg of the plan, from rest to rest."""
        ...

    def measure(self) -> Pose:
        """Where it ended, from where it began."""
        ...


Act = Callable[[], str]
"""What a person does at a question, and then types."""


class Person:
    """Does what is asked, but for what `instead` says of a question: at its n-th time, from 1."""

    def __init__(self, body: Body, instead: Mapping[tuple[str, int], Act | str] | None = None) -> None:
        self._body = body
        self._instead = instead or {}
        self._asked: Counter[str] = Counter()
        self._leg = ""
        self._pose = Pose(0.0, 0.0, 0.0)
        self.told: list[str] = []
        self.shown: list[str] = []
        """Of each question: what was shown at its end."""

    def show(self, text: str) -> None:
        self.told.append(text)
        if found := re.search(r"Run \d+ of \d+: (\w+ \w+)", text):
            self._leg = found[1]

    def ask(self, question: str, meanwhile: Callable[[], str]) -> str:
        what = next(
            what for what in ("Mark", "Drive", "ahead", "aside", "heading", "ENTER", "Write") if what in question
        )
        self._asked[what] += 1
        assert self._asked[what] < _PATIENCE, f"asked again and again: {self.told[-3:]}"
        act = self._instead.get((what, self._asked[what]))
        answer = act() if callable(act) else self._do(what) if act is None else act
        self.shown.append(meanwhile())
        return answer

    def count(self, what: str) -> int:
        """How often a question was asked."""
        return self._asked[what]

    def drive(self) -> str:
        """What the leg asks for."""
        self._body.drive(self._leg)
        self._pose = self._body.measure()
        return ""

    def _do(self, what: str) -> str:
        if what == "Drive":
            return self.drive()
        answers = {
            "ahead": f"{self._pose.x:.4f}",
            "aside": f"{self._pose.y:.4f}",
            "heading": f"{self._pose.heading:.2f}deg",
        }
        return answers.get(what, "yes" if what == "Write" else "")


class FiledRobot:
    """Rolls as its file says, and tells its wheels."""

    def __init__(self) -> None:
        self.waiting: list[Wheels] = []
        self.silence = 0.0
        self.boot_id, self.instance = 1, "base-1"
        self.is_heard = True
        self.robot_ns = 1
        self._seq, self._us = 0, _WRAP - 3_000_000
        self._ticks = [(1 << 31) - 1000.0, -(1 << 31) + 1000.0]  # both soon wrap
        self._end = Pose(0.0, 0.0, 0.0)
        self.stand()

    def poll(self) -> list[Wheels]:
        heard, self.waiting = self.waiting, []
        return heard

    def drive(self, leg: str) -> None:
        kind, _, side = leg.partition(" ")
        for left, right in {"line": _LINE, "turns": _TURN * 3, "square": _SIDE * 4}[kind]:
            self.roll(*((right, left) if side == "right" else (left, right)))
        self.stand()
        self._end = Pose(5.0 if kind == "line" else 0.0, 0.0, 0.0)

    def measure(self) -> Pose:
        return self._end

    def stand(self, seconds: float = 1.0) -> None:
        for _ in range(round(seconds * _RATE)):
            self._say()

    def roll(self, left: float, right: float) -> None:
        """m of either wheel."""
        steps = math.ceil(max(abs(left), abs(right)) / _SPEED * _RATE)
        for _ in range(steps):
            self._ticks[0] += left / steps * GEOMETRY.ticks_per_metre
            self._ticks[1] += right / steps * GEOMETRY.ticks_per_metre
            self._say()

    def leap(self) -> None:
        """A counter does."""
        self._ticks[0] += 1e6
        self._say()

    def _say(self) -> None:
        self._us = (self._us + round(1e6 / _RATE)) % _WRAP
        if not self.is_heard:
            return
        left, right = (signed32(math.floor(ticks)) for ticks in self._ticks)
        sample = msgspec.structs.replace(wheels(self.robot_ns), left_ticks=left, right_ticks=right)
        sample = msgspec.structs.replace(sample, board_us=self._us, boot_id=self.boot_id, instance=self.instance)
        self.waiting.append(sample)
