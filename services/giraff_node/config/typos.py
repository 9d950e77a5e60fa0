"""What of robot file and environment nobody reads, and may have been meant for the network, or to name robot or file.

What a table knows is what its `Struct` has. What else is wrong with a robot file is no business of this module.
"""

from collections.abc import Iterable, Iterator, Mapping
from importlib import import_module
from types import UnionType
from typing import Any, Final, get_args, get_origin, get_type_hints

import msgspec

from giraff_core.network import NetworkConfig
from giraff_core.robot import RobotConfig
from giraff_node.config.robot_file import RawSettings, UnknownEntry
from giraff_schemas.services import ROBOT_TABLES, SERVICES
from giraff_schemas.text import near

_NETWORK: Final = {
    **{field: f"{field!r} of [network]" for field in NetworkConfig.__struct_fields__},
    **{f"network_{field}": f"{field!r} of [network]" for field in NetworkConfig.__struct_fields__},
    **dict.fromkeys(("secured", "security"), "'mode' of [network]"),
    "network": "the table [network]",
    "robot": "the table [robot]",
}
_NAME: Final = dict.fromkeys(("name", "robot_name", "id", "robot_id"), "'name' of [robot]")
_FILE: Final = dict.fromkeys(("config", "configuration", "file", "config_file", "robot_file"), "GIRAFF_CONFIG")
"""By word: what may have been meant by it."""
_ALIKE: Final = 0.75
"""Share of their letters that two words have in common, from which on one may be the other mistyped."""
_PREFIX: Final = "GIRAFF_"
_VARIABLES: Final = (
    "GIRAFF_CONFIG",
    "GIRAFF_ROBOT_NAME",
    *(f"GIRAFF_NETWORK_{field.upper()}" for field in NetworkConfig.__struct_fields__),
)


def find_misplaced(given: RawSettings, environment: Mapping[str, str], *, is_named: bool) -> list[UnknownEntry]:
    """With what is wrong with each. `is_named`: the robot is known, whatever they say of its name."""
    words = _NETWORK | _FILE | ({} if is_named else _NAME)
    found = [strange for strange in given.strange if _is_doubtful(strange, words)]
    for table, values in given.tables.items():
        if table == "network":  # where all that is wrong is refused anyway
            continue
        for path, value, meant in _misplaced(table, values, words):
            what = f"{given.place(table)}: unknown field `{'.'.join(path)}`; did you mean {meant}?"
            setting = f"{_PREFIX}{table}_{path[0]}".upper()
            variable = next((each for each in given.variables if each.upper() == setting), "")
            found.append(UnknownEntry(path[-1], value, what, variable))
    variables = [each for each in _VARIABLES if not (is_named and each == "GIRAFF_ROBOT_NAME")]
    for variable, text in environment.items():
        begins = variable[: len(_PREFIX)]
        if begins != _PREFIX and _alike(begins.upper(), (_PREFIX,)) and (meant := _alike(variable.upper(), variables)):
            found.append(UnknownEntry(variable, text, f"{variable}: nobody reads it; did you mean {meant}?", variable))
    return found


def _is_doubtful(strange: UnknownEntry, words: Mapping[str, str]) -> bool:
    word, value = strange.word, strange.value
    table, _, field = word.partition("_")
    if strange.variable and table in ROBOT_TABLES:
        is_plain = table == "network" or (table == "robot" and field in ("", "name"))
        return is_plain or any(_misplaced(table, {field: value}, words))
    if near(table, ("network", "robot")) or word.endswith(tuple(_NETWORK)):
        return True
    if _alike(table, (*_NETWORK, *_FILE)) or _alike(word, words):
        return True
    return isinstance(value, dict) and any(_misplaced(_alike(word, ROBOT_TABLES), value, words))


def _misplaced(
    table: str, values: Mapping[str, Any], words: Mapping[str, str]
) -> Iterator[tuple[tuple[str, ...], Any, str]]:
    """What of a table is not its own: where it stands, its value, and what may have been meant."""
    for path, value in _entries(values):
        name = path[-1].lower()
        if _alike(name, words):
            kind: Any = config_of(table)
            for key in path[:-1]:
                kind = _type_of(kind, key)
            # A mistyped name of the robot is in doubt where it stands.
            own = [field for field in _fields(kind) if (kind, field) != (RobotConfig, "name")]
            meant = _alike(name, (*own, *words))
            if meant not in own and not _is_own(kind, path[-1], value):
                yield path, value, words[meant]


def _entries(values: Mapping[str, Any], above: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], Any]]:
    """All of a table, and of those in it, by their paths."""
    for key, value in values.items():
        path = (*above, key)
        yield path, value
        for inner in value if isinstance(value, list) else [value]:
            if isinstance(inner, dict):
                yield from _entries(inner, path)


def config_of(table: str) -> Any:
    """The `Struct` of a table; None: there is no such table."""
    if table == "robot":
        return RobotConfig
    # Services and simulator stand above this package: one is imported only where something is in doubt.
    package = {service.table: service.package for service in SERVICES if service.table} | {"sim": "giraff_sim"}
    return getattr(import_module(f"{package[table]}.config"), f"{table.capitalize()}Config") if table else None


def _fields(kind: Any) -> tuple[str, ...]:
    """Return those of a `Struct`, or of all in a union; of any other type none."""
    if isinstance(kind, UnionType):
        return tuple(field for each in get_args(kind) for field in _fields(each))
    return kind.__struct_fields__ if isinstance(kind, type) and issubclass(kind, msgspec.Struct) else ()


def _type_of(kind: Any, key: str) -> Any:
    """The type of what stands under this key; None: there is no such key."""
    if get_origin(kind) is dict:
        return get_args(kind)[1]
    kinds = get_args(kind) if isinstance(kind, UnionType) else (kind,)
    return next((get_type_hints(each)[key] for each in kinds if key in _fields(each)), None)


def _is_own(kind: Any, key: str, value: Any) -> bool:
    """Whether a table of this type has the key. One of free names has it where the value can be one of its own."""
    inner = _type_of(kind, key)
    if inner is None or key in _fields(kind):
        return inner is not None
    if _fields(inner):
        return isinstance(value, dict)
    try:
        msgspec.convert(value, inner, strict=False)
    except msgspec.ValidationError:
        return False
    return True


def _alike(word: str, known: Iterable[str]) -> str:
    """The one of these that it is, or may be mistyped; empty: none."""
    return next(iter(near(word, known, cutoff=_ALIKE)), "")
