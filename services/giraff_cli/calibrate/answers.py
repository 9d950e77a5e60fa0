"""What a person types: numbers with or without a unit, and words."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Final

METRES: Final[Mapping[str, float]] = {"": 1.0, "mm": 0.001, "cm": 0.01, "m": 1.0}
"""Units of a length, and what they are of a metre; the longer names first."""
DEGREES: Final[Mapping[str, float]] = {"": math.radians(1.0), "deg": math.radians(1.0), "°": math.radians(1.0)}
"""Of an angle, and what they are of a radian."""


class NumberError(ValueError):
    """What was typed is none. The message says what to type."""


def number(text: str, units: Mapping[str, float]) -> float:
    """In SI units. A comma is a decimal point, too. Raises NumberError."""
    unit = next((unit for unit in units if unit and text.endswith(unit)), "")
    digits = text.removesuffix(unit).strip().replace(",", ".").replace("\N{MINUS SIGN}", "-")
    try:
        value = float(digits)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise NumberError(f"{text or 'nothing'}: no number; type one like 5.012 or -0.03")
    return value * units[unit]
