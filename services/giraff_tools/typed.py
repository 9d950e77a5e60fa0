"""Read numbers, lengths, angles, points and poses as they are typed.

Each function raises ValueError for the rest, with what to type instead.
"""

import math
import re
import shlex
import sys
from collections.abc import Callable, Mapping, Sequence
from typing import Final

from giraff_core.kinematics.pose import Pose

_NUMBER: Final = r"(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?"
_LENGTH: Final = re.compile(rf"([+-]?{_NUMBER})\s*m?")
_ANGLE: Final = re.compile(
    rf"(?P<sign>[+-]?)\s*(?:(?P<number>{_NUMBER})\s*(?:\*\s*(?=pi|π))?)?(?P<pi>pi|π)?"
    rf"(?:\s*/\s*(?P<by>{_NUMBER}))?\s*(?P<unit>deg|°|rad)?"
)
_LIKE: Final = "write it like 90deg, 1.57rad, pi/2 or -3pi"
_METRES: Final[Mapping[str, float]] = {"": 1.0, "mm": 0.001, "cm": 0.01, "m": 1.0}
_DECIMAL: Final = re.compile(r"([+-]?(?:[0-9]+[.,]?[0-9]*|[.,][0-9]+)) *([a-z]*)")
"""What a person writes: float() would also take 3_1, 1e3 and the digits of other scripts."""


def length(text: str) -> float:
    """Return m, of `2`, `-0.5` or `2m`."""
    match = _LENGTH.fullmatch(text.strip())
    value = float(match[1]) if match else math.nan
    if not math.isfinite(value):
        raise ValueError(_without_comma(text, _LENGTH) or f"{text!r} is no length: give metres, like 2 or -0.5")
    return value


def angle(text: str) -> float:
    """Return rad, of `180deg`, `180°`, `1.57`, `1.57rad`, `pi`, `3pi`, `-pi/2`.

    A number alone is radians, up to a turn. Beyond that it was hardly meant so.
    """
    value, has_unit = _angle(text)
    if not has_unit and abs(value) > math.tau:
        raise ValueError(f"{text} is more than a turn in radians: {text.strip()}deg, or {text.strip()}rad")
    return value


def angle_with_unit(text: str, before: str = "") -> float:
    """Return rad, and refuse a number alone. `before`: what the message writes before the angle."""
    value, has_unit = _angle(text)
    if not has_unit:
        text = text.strip()
        raise ValueError(f"{text} has no unit: {before}{text}deg, or {before}{text}rad")
    return value


def point(text: str) -> tuple[float, float]:
    """Return m, m, of `1.5,-2`."""
    x, _, y = text.partition(",")
    try:
        return length(x), length(y)
    except ValueError:
        raise ValueError(f"{text!r} is no point: give x and y in metres, like 1.5,-2") from None


def pose(text: str) -> Pose:
    """Return the pose of `1.5,-2,90deg`: its yaw has a unit."""
    try:
        x, y, yaw = map(str.strip, text.split(","))
        place = length(x), length(y)
        _angle(yaw)
    except ValueError:
        raise ValueError(f"{text!r} is no pose: give X,Y,YAW without a space, like 1.5,-2,90deg") from None
    return Pose(*place, angle_with_unit(yaw, f"{x},{y},"))


def one_word(words: Sequence[str], read: Callable[[str], object], unit: str = "") -> str:
    """Return the only word. Of several, raise ValueError with the one that they should have been.

    `read`: takes what the word may be; `unit`: of the last number, where it has none.
    """
    if len(words) == 1:
        return words[0]
    word = ",".join(each.strip(", ") for each in words)
    try:
        read(word)
    except ValueError:
        read(word := f"{word}{unit}")
    raise ValueError(f"write it as one word: {_retyped(words, word)}")


def _retyped(words: Sequence[str], word: str) -> str:
    """Return the command line with one word in the place of several; only that word where these cannot be found."""
    line, count = sys.argv[1:], len(words)
    for at in range(len(line) - count, 0, -1):  # from the end: the value of an option before them may be equal
        before = line[at - 1]
        if line[at : at + count] == [*words] and (before == "--" or not before.startswith("--")):
            return shlex.join(["giraff", *line[:at], word, *line[at + count :]])
    return f"write {word}"


def _without_comma(text: str, pattern: re.Pattern[str]) -> str:
    """Say how a number with a decimal comma is written; empty: it has none."""
    dotted = text.strip().replace(",", ".", 1)
    return f"{text} has a comma: write {dotted}" if "," in text and pattern.fullmatch(dotted) else ""


def _angle(text: str) -> tuple[float, bool]:
    """Return rad, or the number as it stands, and whether it says which."""
    match = _ANGLE.fullmatch(text.strip())
    if match is None or not (match["number"] or match["pi"]) or (match["pi"] and match["unit"] in ("deg", "°")):
        raise ValueError(_without_comma(text, _ANGLE) or f"{text!r} is no angle: {_LIKE}")
    value = float(match["number"] or 1.0) * (math.pi if match["pi"] else 1.0)
    by = float(match["by"] or 1.0)
    value = (-1.0 if match["sign"] == "-" else 1.0) * (value / by if by else math.nan)
    if not math.isfinite(value):
        raise ValueError(f"{text!r} is no finite angle: {_LIKE}")
    in_degrees = match["unit"] in ("deg", "°")
    return math.radians(value) if in_degrees else value, bool(match["unit"] or match["pi"])


def number(text: str) -> float:
    """Return m, of what a person has measured: with a decimal point or a comma, and with mm, cm, m or nothing."""
    typed = _DECIMAL.fullmatch(text.replace("\N{MINUS SIGN}", "-"))
    value = float(typed[1].replace(",", ".")) if typed and typed[2] in _METRES else math.inf
    if typed is None or math.isinf(value):
        raise ValueError(f"{text or 'nothing'}: no number; type one like 5.012 or -0.03")
    return value * _METRES[typed[2]]


def heading(text: str) -> float:
    """Return rad, of what a person has measured: with a decimal point or a comma, and a unit."""
    return angle_with_unit(text.replace("\N{MINUS SIGN}", "-").replace(",", "."))
