"""What is driven and measured by hand, as data.

Why so many lines: where one ends is measured to 5 mm on either axis and half a degree, and so are its marks. By the
Fisher information of these measures four lines of 5 m and three turns each way give either wheel to 0.08 % and the
track to 0.08 % (standard deviations); two lines would leave 0.11 %. The length counts most: four lines of 7 m give the
wheels to 0.055 %. Left and right turns keep apart what one direction alone mixes: J. Borenstein, L. Feng, Measurement
and Correction of Systematic Odometry Errors in Mobile Robots, IEEE Transactions on Robotics and Automation 12 (1996).
"""

import math
from typing import Final, NamedTuple

POSITION_SD: Final = 0.005
"""m on either axis, of marks and of what is measured from them with a tape."""
YAW_SD: Final = math.radians(0.5)
"""rad; of a straight edge of 1 m that is laid along both wheels: 9 mm over its length."""


class Leg(NamedTuple):
    """One run from rest to rest."""

    name: str
    task: str
    """What to drive."""
    path: tuple[float, float]
    """m, least and most that the robot's middle then goes."""
    turned: tuple[float, float]
    """rad, least and most that it then turns to the left."""
    is_check: bool = False
    """It judges the calibration, and is never fitted."""


_LINE_PATH: Final = (3.0, 30.0)
_LINE_TURNED: Final = (-math.pi / 3.0, math.pi / 3.0)
_SPIN_PATH: Final = (0.0, 1.5)
_TURNS: Final = (2.0, 4.25)
"""Whole turns are not measured. Odometry tells them apart while it is wrong by less than half a turn: with wheels 2 %
off, a track 3 % off and 1 % of each turn lost it is 92 degrees off after 4.25 turns; with 5 % more, 168."""
_SQUARE_PATH: Final = (4.0, 40.0)
_SQUARE_TURNED: Final = (math.radians(270.0), math.radians(450.0))


def _line(number: int, *, way: str) -> Leg:
    return Leg(
        f"line {number}",
        f"about 5 m straight forward, {way}; longer is better",
        _LINE_PATH,
        _LINE_TURNED,
    )


def _spin(side: str, turned: tuple[float, float]) -> Leg:
    return Leg(f"turns {side}", f"three whole turns on the spot to the {side}", _SPIN_PATH, turned)


def _square(side: str, turned: tuple[float, float]) -> Leg:
    task = f"a square of about 2 m to the {side}, forward all the way, back to near its marks and heading"
    return Leg(f"square {side}", task, _SQUARE_PATH, turned, is_check=True)


def _to_the_right(turned: tuple[float, float]) -> tuple[float, float]:
    return -turned[1], -turned[0]


_SPIN_TURNED: Final = (_TURNS[0] * math.tau, _TURNS[1] * math.tau)

PLAN: Final[tuple[Leg, ...]] = (
    _line(1, way="one way"),
    _line(2, way="the other way"),
    _line(3, way="one way again"),
    _line(4, way="the other way again"),
    _spin("left", _SPIN_TURNED),
    _spin("right", _to_the_right(_SPIN_TURNED)),
    _square("left", _SQUARE_TURNED),
    _square("right", _to_the_right(_SQUARE_TURNED)),
)
