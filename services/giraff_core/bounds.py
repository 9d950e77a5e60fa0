"""What the numbers of a robot file can be. The range of a field stands beside it.

The ranges hold any robot on two driven wheels of 0.1 to 2 m, and far more. What is outside is a slip: degrees for
radians, millimetres for metres, a digit too many.
"""

import functools
import math
from typing import Final, NamedTuple, get_args, get_type_hints

import msgspec

_MOST: Final = 1e9
"""Of any unit: as seconds it is 30 years and fits into 64 bits of ns; what is squared and summed stays finite."""
_AT_MOST: Final = f", {_MOST:g} at most"
_MISTAKEN: Final = {
    "m": "are these millimetres?",
    "m/s": "are these millimetres a second?",
    "m/s²": "are these millimetres per second squared?",
    "rad": "are these degrees?",
    "rad/s": "are these degrees a second?",
    "s": "are these milliseconds?",
    "V": "are these millivolts?",
}
"""By unit, what is likely where a number is too large."""
_ANGLES: Final = {
    -math.tau: "-2π",
    -math.pi / 4: "-π/4",
    math.pi / 6: "π/6",
    math.pi / 4: "π/4",
    math.pi / 2: "π/2",
    math.tau: "2π",
}


class Bounds(NamedTuple):
    """`track_width: Annotated[float, Bounds(0.05, 2.0, "m")]`; None, where the type has it, is no number."""

    low: float
    high: float
    unit: str = ""
    hint: str = ""
    """Likely cause, where the unit does not tell it."""

    def require(self, name: str, value: float) -> None:
        """ValueError unless it is in here."""
        if self.low <= value <= self.high:
            return
        cause = self.hint or (self._mistaken(value) if abs(value) > self.high else "")
        bounds = f"{_shown(self.low)}..{_shown(self.high)} {self.unit}".rstrip()
        raise ValueError(f"{name} is {value:.10g}: it must be within {bounds}{cause and f'; {cause}'}")

    def _mistaken(self, value: float) -> str:
        """Return what the unit tells of a number that is too large; of degrees also their value in radians."""
        radians = math.radians(value)
        if self.unit == "rad" and self.low <= radians <= self.high:
            return f"{_MISTAKEN['rad']} {value:.10g} degrees are {radians:.5g} rad"
        return _MISTAKEN.get(self.unit, "")


def check_bounds(config: msgspec.Struct) -> None:
    """ValueError unless each field is within the range that stands beside it."""
    for name, within in bounds_of(type(config)).items():
        value = getattr(config, name)
        if value is not None:
            within.require(name, value)


@functools.cache
def bounds_of(config: type[msgspec.Struct]) -> dict[str, Bounds]:
    """By field."""
    hints = get_type_hints(config, include_extras=True)
    told = {name: [each for each in get_args(hint) if isinstance(each, Bounds)] for name, hint in hints.items()}
    return {name: found[0] for name, found in told.items() if found}


def require_positive(config: msgspec.Struct, *names: str) -> None:
    """ValueError unless each of these fields is a number above 0 that can be counted with."""
    for name in names:
        value = getattr(config, name)
        if not (_is_countable(value) and value > 0.0):
            raise ValueError(f"{name} is {value}: it must be a positive number{_AT_MOST}")


def require_not_negative(config: msgspec.Struct, *names: str) -> None:
    """ValueError unless each of these fields is a number, 0 or above, that can be counted with."""
    for name in names:
        value = getattr(config, name)
        if not (_is_countable(value) and value >= 0.0):
            raise ValueError(f"{name} is {value}: it must be zero or a positive number{_AT_MOST}")


def _is_countable(value: float) -> bool:
    return isinstance(value, int) or (math.isfinite(value) and value <= _MOST)


def _shown(bound: float) -> str:
    return _ANGLES.get(bound) or f"{bound:g}"
