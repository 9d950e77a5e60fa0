"""Fields of `[robot]` that stand in `[base.drive]` now. Files, variables and recordings of before mean the same."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final, NamedTuple

from giraff_core.robot import MOVED_TO_DRIVE, WIRING
from giraff_schemas.trouble import WELL, Trouble

_BEFORE: Final = "robot"
_NOW: Final = ("base", "drive")
_TYPE: Final = "wheels"
"""The only drive that there was before."""
_IN_TABLE: Final = "__"
"""Goes into a table, in the name of a variable."""


class Modern(NamedTuple):
    """Tables as a robot file of today has them."""

    tables: dict[str, Any]
    moved: Trouble
    """What stood elsewhere, and where it belongs."""
    twice: str
    """What is given in both places, and what to do; empty: nothing is."""


def modern(tables: Mapping[str, Any]) -> Modern:
    """Return the tables with each field where it stands now."""
    old = [field for field in MOVED_TO_DRIVE if field in _table(tables, _BEFORE)]
    base = tables.get(_NOW[0], {})
    drive = base.get(_NOW[1], {}) if isinstance(base, Mapping) else None
    if not old or not isinstance(drive, Mapping) or drive.get("type", _TYPE) != _TYPE:
        # Other code refuses a value where a table belongs, and these fields beside a drive of another type.
        return Modern(dict(tables), WELL, "")
    before = dict(tables[_BEFORE])
    moved = {field: before.pop(field) for field in old}
    current = {**tables, _BEFORE: before, _NOW[0]: {**base, _NOW[1]: {"type": _TYPE, **moved, **drive}}}
    names, place = ", ".join(old), ".".join(_NOW)
    twice = ", ".join(field for field in old if field in drive)
    return Modern(
        current,
        Trouble(f"[{_BEFORE}] has {names}", f"write that into [{place}], as deploy/robot.toml does"),
        twice and f"[{_BEFORE}] and [{place}] both have {twice}; remove that from [{_BEFORE}]",
    )


def table_of_wiring(tables: Mapping[str, Any]) -> str:
    """Return the table in which a file has its wiring, or takes it. Raises ValueError where it has it in both."""
    drive = _table(_table(tables, _NOW[0]), _NOW[1])
    before, now = (any(field in table for field in WIRING) for table in (_table(tables, _BEFORE), drive))
    place = ".".join(_NOW)
    if before and now:
        raise ValueError(f"the wiring stands in [{_BEFORE}] and in [{place}]; write all of it into [{place}]")
    return _BEFORE if before or not drive else place


def path_of(variable: str) -> tuple[str, ...]:
    """Return the tables and the field that a variable sets: GIRAFF_BASE_DRIVE__MAX_LEVEL is base, drive, max_level."""
    table, _, field = variable.removeprefix("GIRAFF_").lower().partition("_")
    first, *inner = field.split(_IN_TABLE)
    return (*(_NOW if table == _BEFORE and first in MOVED_TO_DRIVE else (table,)), first, *inner)


def current_name(variable: str) -> str:
    """Return the variable that sets the same field now."""
    path = path_of(variable)
    is_moved = path[: len(_NOW)] == _NOW and variable.upper().startswith(f"GIRAFF_{_BEFORE}_".upper())
    return f"GIRAFF_{path[0]}_{_IN_TABLE.join(path[1:])}".upper() if is_moved else variable


def put(tables: dict[str, Any], path: tuple[str, ...], value: Any) -> None:
    """Set a value, and make the tables that are missing. Raises TypeError where something else stands there."""
    *above, last = path
    inner: Any = tables
    for name in above:
        inner = inner.setdefault(name, {})
        if not isinstance(inner, dict):
            raise TypeError(f"{name} is no table")
    inner[last] = value


def name_type(tables: dict[str, Any]) -> None:
    """Name the type of the drive that a variable of before has set, where nothing names it."""
    put(tables, (*_NOW, "type"), tables[_NOW[0]][_NOW[1]].get("type", _TYPE))


def _table(tables: Mapping[str, Any], name: str) -> Mapping[str, Any]:
    found = tables.get(name)
    return found if isinstance(found, Mapping) else {}
