"""The steps of a motion, and patterns of them in TOML files, which are read as they are written."""

from pathlib import Path
from typing import Any, Final, Literal

import msgspec

from giraff_core.motion.wish import Wish
from giraff_core.toml_kinds import PATTERN, wrong_kind
from giraff_node.config.robot_file import parse_toml
from giraff_schemas.motion import Arc, GoTo, Move, Step, Turn
from giraff_schemas.text import plain
from giraff_tools.typed import angle

_MOST: Final = 1_000_000  # bytes; more is no pattern
_KINDS: Final = 'move = 2.0, turn = "180deg", arc = {radius = 1.0, angle = "90deg"} or go_to = [1.0, 0.0]'


class PatternError(Exception):
    """The file is no pattern. The message says where, and the way out."""


class _Arc(msgspec.Struct, forbid_unknown_fields=True):
    radius: float
    angle: float | str


class _Step(msgspec.Struct, forbid_unknown_fields=True):
    move: float | None = None
    turn: float | str | None = None
    arc: _Arc | None = None
    go_to: tuple[float, float] | None = None
    frame: Literal["odom", "map"] | None = None
    """Of `go_to`."""


class _Pattern(msgspec.Struct, forbid_unknown_fields=True):
    speed: float | None = None
    turn_speed: float | None = None
    time_limit: float | None = None
    step: list[_Step] = []


def read_pattern(path: Path) -> Wish:
    """What the file asks for. Raises PatternError."""
    try:
        text = _text(path)
    except OSError as error:
        raise PatternError(f"{path}: {error.strerror}") from error
    except ValueError as error:
        raise PatternError(f"{path}: {plain(error)}") from error
    try:
        tables = parse_toml(text)
    except ValueError as error:
        raise PatternError(f"{path}: no TOML: {error}") from error
    try:
        pattern = msgspec.convert(tables, _Pattern)
    except ValueError as error:
        why = wrong_kind(tables, PATTERN) or plain(error)
        raise PatternError(f"{path}: {why}; a step is one of {_KINDS}") from error
    try:
        return _wish(pattern)
    except ValueError as error:
        raise PatternError(f"{path}: {error}") from error


def _text(path: Path) -> str:
    with path.open("rb") as file:
        data = file.read(_MOST + 1)
    if len(data) > _MOST:
        raise ValueError(f"it has over {_MOST} bytes, which is no pattern")
    return data.decode()


def _wish(pattern: _Pattern) -> Wish:
    for name in ("speed", "turn_speed", "time_limit"):
        value: float | None = getattr(pattern, name)
        if value is not None and not 0.0 < value < float("inf"):
            raise ValueError(f"{name} is {value:g}: give a positive number")
    if not pattern.step:
        raise ValueError(f"it has no [[step]]; one has {_KINDS}")
    steps = []
    for number, step in enumerate(pattern.step, 1):
        try:
            steps.append(_step(step))
        except ValueError as error:
            raise ValueError(f"step {number}: {error}") from error
    return Wish(tuple(steps), pattern.speed, pattern.turn_speed, pattern.time_limit)


def _step(step: _Step) -> Step:
    given: dict[str, Any] = {name: value for name, value in msgspec.structs.asdict(step).items() if value is not None}
    frame = given.pop("frame", "odom")
    if step.frame is not None and step.go_to is None:
        raise ValueError(f"it has a frame, {frame}, and no go_to: only a point is in a frame")
    if len(given) != 1:
        raise ValueError(f"it has {' and '.join(given) or 'nothing'}: give one of {_KINDS}")
    match given.popitem():
        case "move", distance:
            return move(distance)
        case "turn", typed:
            return turn(_angle(typed))
        case "arc", _Arc(radius=radius, angle=typed):
            return arc(radius, _angle(typed))
        case _, (x, y):
            return GoTo(x=x, y=y, frame=frame)
    raise AssertionError(step)


def _angle(typed: float | str) -> float:
    return angle(str(typed).removesuffix(".0"))


def move(distance: float) -> Move:
    """Straight on. Raises ValueError for a way of no length."""
    if distance == 0.0:
        raise ValueError("a move of 0 m goes nowhere: give metres, negative for backward")
    return Move(distance=distance)


def turn(radians: float) -> Turn:
    """On the spot. Raises ValueError for no turn."""
    if radians == 0.0:
        raise ValueError("a turn of 0 turns nothing: write it like 90deg, negative for one to the right")
    return Turn(angle=radians)


def arc(radius: float, radians: float) -> Arc:
    """Along a circle. Raises ValueError for one that is none."""
    if radius <= 0.0:
        raise ValueError(f"a radius of {radius:g} m is none: give one above 0; a negative angle goes to the right")
    if radians == 0.0:
        raise ValueError("an arc of 0 goes nowhere: write its angle like 90deg, negative for one to the right")
    return Arc(radius=radius, angle=radians)
