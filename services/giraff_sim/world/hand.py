"""What holds the joystick: the acceleration that its BNO055 feels. m/s^2, seconds, metres, radians.

Axes are the board's: x grows when it is tilted forward (drive forward), y when it is tilted to the left (turn
left), z is up, 9.81 when it lies flat.
"""

import bisect
import csv
import math
import random
import statistics
from pathlib import Path
from typing import Final, Protocol

from giraff_schemas.text import plain
from giraff_sim.world.bno055 import GRAVITY, Vector
from giraff_sim.world.room import Pose

LEVEL: Final[Vector] = (0.0, 0.0, GRAVITY)

_TILTED: Final[Vector] = (GRAVITY * math.sin(math.radians(40.0)), 0.0, GRAVITY * math.cos(math.radians(40.0)))
_SHAKE_HZ: Final = 5.0
_SHAKE: Final = 20.0  # m/s^2, peak: 2 cm each way
_FALL: Final = 0.45  # s, from a metre
_TUMBLE: Final = 6.0  # rad/s
_OFF_CENTRE: Final = 0.03  # m
_IMPACT: Final[Vector] = (25.0, -15.0, 30.0)
_BUMP: Final = 0.03  # s
_WAVES: Final = 3
_TREMOR_HZ: Final = (6.0, 12.0)

_COLUMNS: Final = ("t", "x", "y", "z")
_DAY: Final = 86_400.0
"""s. Largest first time of a script, and its longest. More counts from 1970, or is in another unit."""
_LIKE_G: Final = (0.7, 1.4)
"""Median acceleration in a script that is in g. A hand that holds still feels 9.8 m/s²."""

_HARDEST: Final = 100.0
"""m/s². Largest median acceleration in a script: no hand keeps up ten times gravity."""


class ScriptError(Exception):
    """A tilt script that cannot be used. The message names file and line."""


class Hand(Protocol):
    """Moves the joystick."""

    @property
    def trembles(self) -> bool:
        """A living hand holds it: the world adds its tremor."""
        ...

    def acceleration(self, seconds: float, robot: Pose) -> Vector:
        """What the sensor feels at a simulated time that never goes back, with the robot truly at `robot`."""
        ...


class StillHand:
    """Holds the joystick as it is, as still as a hand can: flat, unless told otherwise."""

    trembles = True

    def __init__(self, vector: Vector = LEVEL) -> None:
        if not all(math.isfinite(value) for value in vector):
            raise ValueError(f"a tilt must be three finite numbers, not {vector}")
        self._vector = vector

    def acceleration(self, seconds: float, robot: Pose) -> Vector:
        del seconds, robot
        return self._vector


class LaidDown(StillHand):
    """Nobody's: the joystick lies on something, tilted forward by 40 degrees unless told otherwise."""

    trembles = False

    def __init__(self, vector: Vector = _TILTED) -> None:
        super().__init__(vector)


class Shaken:
    """Shakes the joystick to and fro, five times a second and by 4 cm."""

    trembles = True

    def __init__(self, begin: float) -> None:
        """`begin`: simulated s."""
        self._begin = begin

    def acceleration(self, seconds: float, robot: Pose) -> Vector:
        del robot
        swing = _SHAKE * math.sin(math.tau * _SHAKE_HZ * (seconds - self._begin))
        return swing, 0.0, GRAVITY


class Dropped:
    """Lets the joystick fall from the hand to the floor, tumbling; there it lies on its edge."""

    trembles = False

    def __init__(self, begin: float) -> None:
        """`begin`: simulated s."""
        self._begin = begin

    def acceleration(self, seconds: float, robot: Pose) -> Vector:
        del robot
        since = seconds - self._begin
        if since < _FALL:
            turn = _TUMBLE * since
            spin = _TUMBLE**2 * _OFF_CENTRE  # the sensor is not where the joystick turns about
            return spin * math.cos(turn), spin * math.sin(turn), 0.0
        return _IMPACT if since < _FALL + _BUMP else _TILTED


class Tremor:
    """A hand's tremor, the same for the same seed: three waves an axis, at 6 to 12 Hz as physiology has it."""

    def __init__(self, amplitude: float, seed: int) -> None:
        """`amplitude`: m/s^2, rms of each axis."""
        chance = random.Random(f"{seed}/tremor")
        peak = amplitude * math.sqrt(2.0 / _WAVES)
        self._axes = [
            [(peak, math.tau * chance.uniform(*_TREMOR_HZ), chance.uniform(0.0, math.tau)) for _ in range(_WAVES)]
            for _ in range(3)
        ]

    def added_to(self, vector: Vector, seconds: float) -> Vector:
        """`vector` as a trembling hand has it."""
        x, y, z = (sum(peak * math.sin(rate * seconds + phase) for peak, rate, phase in axis) for axis in self._axes)
        return vector[0] + x, vector[1] + y, vector[2] + z


class ScriptedHand:
    """Repeats a tilt script: each row holds until the next one's time, the last one for ever.

    Rows are held and not joined by lines, so that a script is exact about what is asked at which moment, and
    a recording at the sensor's own rate is replayed as it was, given a [sim] whose `hand_tremor` is 0.
    """

    trembles = True

    def __init__(self, times: list[float], vectors: list[Vector]) -> None:
        self._times = times
        self._vectors = vectors

    def acceleration(self, seconds: float, robot: Pose) -> Vector:
        del robot
        return self._vectors[max(0, bisect.bisect_right(self._times, seconds) - 1)]


def read_script(path: Path, begin: float = 0.0) -> ScriptedHand:
    """A tilt script: CSV rows t, x, y, z (s from `begin`, m/s^2), times growing; row 1 may name them."""
    times: list[float] = []
    vectors: list[Vector] = []
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:  # Excel begins a file by a mark
            for number, row in enumerate(csv.reader(file, skipinitialspace=True), 1):
                if not row or (number == 1 and tuple(cell.strip() for cell in row) == _COLUMNS):
                    continue
                time, *vector = _numbers(row, f"{path}:{number}")
                if times and time + begin <= times[-1]:
                    before = times[-1] - begin
                    raise ScriptError(f"{path}:{number}: time {time:g} does not come after {before:g}")
                if not times and time > _DAY:
                    raise ScriptError(
                        f"{path}:{number}: time {time:.15g} is none in s from the start: take it off each row"
                    )
                times.append(time + begin)
                vectors.append((vector[0], vector[1], vector[2]))
    except OSError as error:
        raise ScriptError(f"{path}: cannot be read: {error.strerror}; name a file of rows t, x, y, z") from error
    except (UnicodeDecodeError, csv.Error) as error:
        raise ScriptError(f"{path}: cannot be read: {plain(error)}; name a file of rows t, x, y, z") from error
    if not times:
        raise ScriptError(f"{path}: holds no row of t, x, y, z")
    _require_units(path, times[-1] - times[0], vectors)
    return ScriptedHand(times, vectors)


def _require_units(path: Path, lasts: float, vectors: list[Vector]) -> None:
    """Raise ScriptError where no hand feels so much, or so little, or where no script lasts so many seconds."""
    felt = statistics.median(math.hypot(*vector) for vector in vectors)
    for scale, unit in ((1.0, "g"), (1000.0, "mg")):
        if _LIKE_G[0] < felt / scale < _LIKE_G[1]:
            raise ScriptError(
                f"{path}: x, y, z make {felt:.2f} together, like {unit}: make them m/s², times {GRAVITY / scale:g}"
            )
    if felt > _HARDEST:
        raise ScriptError(f"{path}: x, y, z make {felt:.4g} together: make them m/s², 9.8 where it is held still")
    if lasts > _DAY:
        raise ScriptError(f"{path}: it lasts {lasts:.4g} s, more than a day: are the times in ms or ns? make them s")


def _numbers(row: list[str], place: str) -> list[float]:
    if len(row) != len(_COLUMNS):
        raise ScriptError(f"{place}: {len(row)} columns where t, x, y, z belong")
    numbers = []
    for name, cell in zip(_COLUMNS, row, strict=True):
        try:
            number = float(cell)
        except ValueError:
            raise ScriptError(f"{place}: {name} is {cell!r}, not a number") from None
        if not math.isfinite(number):
            raise ScriptError(f"{place}: {name} is {cell.strip()}: it must be finite")
        numbers.append(number)
    return numbers
