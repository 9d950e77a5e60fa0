"""Numbers that no message can hold, and paths that nobody must read.

The checks of `__post_init__` run for every sample on both sides: text comes only of a fault.
"""

from contextlib import suppress
from math import isfinite
from pathlib import Path
from typing import Any, Final, TypeVar

import msgspec

from giraff_schemas.text import plain

T = TypeVar("T")
_WRITTEN_OUT: Final = 128  # bits


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


def require_sendable(value: Any) -> None:
    """ValueError where a number that somebody has written, or one within a list or a table, fits into no message."""
    if isinstance(value, (dict, list, tuple)):
        for inner in (*value, *value.values()) if isinstance(value, dict) else value:
            require_sendable(inner)
    elif isinstance(value, int) and not -(1 << 63) <= value < 1 << 64:
        raise ValueError(f"{_short(value)} is beyond 64 bits: no message can hold it")
    elif isinstance(value, float) and not isfinite(value):
        raise ValueError(f"{value} is not a finite number")


def _short(value: int) -> str:
    """The number, which may have more digits than Python writes."""
    return str(value) if value.bit_length() <= _WRITTEN_OUT else f"a number of {value.bit_length()} bits"


def converted(value: Any, type_: type[T], *, strict: bool = True) -> T:
    """Return what somebody has written as a `type_`. ValueError: it is none, or fits into no message."""
    try:
        found = msgspec.convert(value, type_, strict=strict)
    except msgspec.ValidationError as error:
        raise ValueError(plain(error)) from error
    require_sendable(msgspec.to_builtins(found))
    return found


def refuse_to_read(path: Path) -> str:
    """Return why a path must not be read, as text; empty: it may be, or its reader says why not.

    A pipe or a device may never end.
    """
    with suppress(OSError):
        if path.exists() and not path.is_file():
            return f"{path}: it is no file, but a folder, a pipe or a device: give the file itself"
    return ""
