"""A place on the map as it is typed. Whatever cannot be meant raises ValueError, with the way out."""

from __future__ import annotations

import math
import secrets
from typing import Final, NamedTuple

from giraff_cli.network.user import user_at_host
from giraff_schemas.localization import LocalizationGlobal, LocalizationSetPose

_EXAMPLE: Final = "give X,Y,YAW in m, m and degrees, like 1.5,2.2,90"
_WHOLE: Final = 360.0  # degrees
_FARTHEST: Final = 10_000.0  # m; no floor plan is so large, and whoever types more means millimetres


class Place(NamedTuple):
    """Of `base_link` in `map`."""

    x: float
    """m"""
    y: float
    """m"""
    yaw: float
    """rad"""

    def request(self) -> LocalizationSetPose:
        """A wish of its own each time."""
        return LocalizationSetPose(by=user_at_host(), id=secrets.randbits(63), x=self.x, y=self.y, yaw=self.yaw)


def anywhere() -> LocalizationGlobal:
    """A wish of its own each time."""
    return LocalizationGlobal(by=user_at_host(), id=secrets.randbits(63))


def place(text: str) -> Place:
    """Of `X,Y,YAW`, the last in degrees."""
    words = text.split(",")
    if len(words) != 3:
        raise ValueError(f"{text!r} has {len(words)} number{'' if len(words) == 1 else 's'}: {_EXAMPLE}")
    try:
        x, y, degrees = map(float, words)
    except ValueError:
        raise ValueError(f"{text!r} is no place: {_EXAMPLE}") from None
    if not all(map(math.isfinite, (x, y, degrees))):
        raise ValueError(f"{text!r} is no place: its numbers must be finite; {_EXAMPLE}")
    if abs(degrees) > _WHOLE:
        raise ValueError(f"YAW {degrees:g}° is more than a whole turn: give degrees from -360 to 360")
    if max(abs(x), abs(y)) > _FARTHEST:
        raise ValueError(f"{text!r} is farther than {_FARTHEST:g} m: X and Y are in metres; are these millimetres?")
    return Place(x, y, math.radians(degrees))
