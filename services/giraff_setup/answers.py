"""What a person types: numbers, with a decimal point or a comma."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Final

from giraff_tools.typed import angle_with_unit

_METRES: Final[Mapping[str, float]] = {"": 1.0, "mm": 0.001, "cm": 0.01, "m": 1.0}
_NUMBER: Final = re.compile(r"([+-]?(?:[0-9]+[.,]?[0-9]*|[.,][0-9]+)) *([a-z]*)")
"""What a person writes: float() would also take 3_1, 1e3 and the digits of other scripts."""


def number(text: str) -> float:
    """Return m. Raises ValueError, which says what to type."""
    typed = _NUMBER.fullmatch(text.replace("\N{MINUS SIGN}", "-"))
    value = float(typed[1].replace(",", ".")) if typed and typed[2] in _METRES else math.inf
    if typed is None or math.isinf(value):
        raise ValueError(f"{text or 'nothing'}: no number; type one like 5.012 or -0.03")
    return value * _METRES[typed[2]]


def heading(text: str) -> float:
    """Return rad. Raises ValueError, which says what to type."""
    return angle_with_unit(text.replace("\N{MINUS SIGN}", "-").replace(",", "."))
