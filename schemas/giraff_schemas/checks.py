"""What `__post_init__` of the messages looks at. It runs for every sample on both sides: text comes only of a fault."""

from __future__ import annotations

from math import isfinite

import msgspec


def require_finite(message: msgspec.Struct, *values: float) -> None:
    """ValueError, with the field's name, where one of these values of `message` is no finite number."""
    for value in values:
        if not isfinite(value):
            raise ValueError(f"{_field_of(message, value)} is {value}, not a finite number")


def _field_of(message: msgspec.Struct, value: float) -> str:
    """The first field that holds this very object: NaN equals nothing, not even itself."""
    found = (_path_to(value, held, name) for name, held in msgspec.structs.asdict(message).items())
    return next(filter(None, found), type(message).__name__)


def _path_to(value: float, held: object, name: str) -> str:
    """Of the very object in what a field holds; empty: it is not there."""
    if held is value:
        return name
    if isinstance(held, tuple):
        found = (_path_to(value, each, f"{name}[{index}]") for index, each in enumerate(held))
        return next(filter(None, found), "")
    return ""


def require_moment(epoch: int, robot_ns: int) -> None:
    """ValueError where the boards could not carry it."""
    if not (0 <= epoch < 1 << 32 and 0 <= robot_ns < 1 << 64):
        raise ValueError(f"epoch {epoch}, robot_ns {robot_ns}: not the boards' 32 and 64 bits")
