"""What a person types: numbers with or without a unit, and words."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Final

METRES: Final[Mapping[str, float]] = {"": 1.0, "mm": 0.001, "cm": 0.01, "m": 1.0}
"""Units of a length, and what they are of a metre."""
DEGREES: Final[Mapping[str, float]] = {"": math.radians(1.0), "deg": math.radians(1.0), "°": math.radians(1.0)}
"""Of an angle, and what they are of a radian."""

_NUMBER: Final = re.compile(r"([+-]?(?:[0-9]+[.,]?[0-9]*|[.,][0-9]+)) *([a-z°]*)")
"""What a person writes: float() would also take 3_1, 1e3 and the digits of other scripts."""


class NumberError(ValueError):
    """What was typed is none. The message says what to type."""


def number(text: str, units: Mapping[str, float]) -> float:
    """In SI units. A comma is a decimal point, too. Raises NumberError."""
    typed = _NUMBER.fullmatch(text.replace("\N{MINUS SIGN}", "-"))
    value = float(typed[1].replace(",", ".")) if typed and typed[2] in units else math.inf
    if typed is None or math.isinf(value):
        raise NumberError(f"{text or 'nothing'}: no number; type one like 5.012 or -0.03")
    return value * units[typed[2]]
