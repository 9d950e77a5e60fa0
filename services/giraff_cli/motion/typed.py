"""Lengths and angles as they are typed. Whatever cannot be meant raises ValueError, with the way out."""

from __future__ import annotations

import math
import re
from typing import Final

_NUMBER: Final = r"(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?"
_LENGTH: Final = re.compile(rf"([+-]?{_NUMBER})\s*m?")
_ANGLE: Final = re.compile(
    rf"(?P<sign>[+-]?)\s*(?:(?P<number>{_NUMBER})\s*(?:\*\s*(?=pi|π))?)?(?P<pi>pi|π)?"
    rf"(?:\s*/\s*(?P<by>{_NUMBER}))?\s*(?P<unit>deg|°|rad)?"
)


def length(text: str) -> float:
    """m, of `2`, `-0.5` or `2m`."""
    match = _LENGTH.fullmatch(text.strip())
    value = float(match[1]) if match else math.nan
    if not math.isfinite(value):
        raise ValueError(f"{text!r} is no length: give metres, like 2 or -0.5")
    return value


def point(text: str) -> tuple[float, float]:
    """m, m, of `1.5,-2`."""
    x, _, y = text.partition(",")
    try:
        return length(x), length(y)
    except ValueError:
        raise ValueError(f"{text!r} is no point: give x and y in metres, like 1.5,-2, without a space") from None


def angle(text: str) -> float:
    """rad, of `180deg`, `180°`, `1.57`, `1.57rad`, `pi`, `3pi`, `-pi/2`.

    A number alone that is more than a whole turn is refused: it was hardly meant in radians.
    """
    match = _ANGLE.fullmatch(text.strip())
    if match is None or not (match["number"] or match["pi"]) or (match["pi"] and match["unit"] in ("deg", "°")):
        raise ValueError(f"{text!r} is no angle: write it like 90deg, 1.57rad, pi/2 or -3pi")
    value = float(match["number"] or 1.0) * (math.pi if match["pi"] else 1.0)
    by = float(match["by"] or 1.0)
    value = (-1.0 if match["sign"] == "-" else 1.0) * (value / by if by else math.nan)
    if not math.isfinite(value):
        raise ValueError(f"{text!r} is no finite angle: write it like 90deg, 1.57rad, pi/2 or -3pi")
    if match["unit"] in ("deg", "°"):
        return math.radians(value)
    if not (match["unit"] or match["pi"]) and abs(value) > math.tau:
        raise ValueError(f"{text} is more than a whole turn: write {text.strip()}deg or {text.strip()}rad")
    return value
