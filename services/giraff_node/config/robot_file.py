"""Strict configuration: the robot file (TOML, one table a service), then the environment.

The file is $GIRAFF_CONFIG, else `deploy/robot.toml` below the working directory; /dev/null is an empty one. A variable
GIRAFF_<TABLE>_<FIELD> (GIRAFF_BASE_PORT, GIRAFF_ROBOT_NAME) overrides one field; two underscores go into a table
(GIRAFF_BASE_DRIVE__MAX_LEVEL). Anything unknown is an error that suggests the right word.
"""

import os
import re
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final, NamedTuple, TypeVar, get_type_hints

import msgspec
import msgspec.inspect

from giraff_core.network import host_and_port
from giraff_core.robot import WIRING
from giraff_core.senses import UnknownSensor, typed
from giraff_schemas.checks import converted, require_sendable
from giraff_schemas.services import ROBOT_TABLES
from giraff_schemas.text import near, plain

ConfigT = TypeVar("ConfigT", bound=msgspec.Struct)

_NOT_FIELDS = ("GIRAFF_CONFIG",)
_IN_TABLE: Final = "__"
"""Goes into a table, in the name of a variable."""
_WRITTEN_AS_TOML: Final = {"[": "list", "{": "table"}
_QUOTED: Final = re.compile(r"""(["'])((?:(?!\1).)*)\1""")
"""A variable of an env file that docker reads: it keeps the quotes, which systemd and shells take away."""
_DEEPEST: Final = 20
"""Tables and lists within each other."""
_TOO_DEEP: Final = "it is nested too deeply"
_PLACE: Final = re.compile(r"at `\$\.([^`]*)`")
_UNKNOWN: Final = re.compile(r"unknown field `([^`]*)`")
_NO_TEXT: Final = re.compile(r"Expected `(\w+)[^`]*`, got `str`")
_NUMBER: Final = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)")
_EXAMPLES: Final = {"float": "0.3", "int": "3", "bool": "true"}
_NO_DRIVE: Final = "Object missing required field `drive`"
DEFAULT_FILE = Path("deploy/robot.toml")
"""The robot file below the working directory, where GIRAFF_CONFIG names no other."""
_EXAMPLE: Final = "giraff"
"""Robot's name in the `deploy/robot.toml` that comes with the source."""
_EXAMPLE_NETWORK: Final = {"rendezvous", "local"}
"""Fields of its table [network], and the one that keeps all to this host."""
NO_FILE: Final = os.devnull
"""What GIRAFF_CONFIG names where no file is to count, wherever one may be: as a robot file it is empty."""


class ConfigError(Exception):
    """A robot file or a variable that cannot be used. The message names where and the way out."""


class RawSettings(NamedTuple):
    """What robot file and environment say. Values are not yet checked."""

    where: str
    """The robot file; "environment" where there is none."""
    tables: dict[str, dict[str, Any]]
    strange: "tuple[UnknownEntry, ...]"
    """What belongs to no table, in the order in which it was met."""
    variables: tuple[str, ...]
    """Those of the environment that have set a field."""

    def table(self, name: str, config: type[ConfigT]) -> ConfigT:
        """The checked table as a `config`, whose fields' defaults stand for what is left out. Raises ConfigError."""
        values = self.tables.get(name, {})
        if name == "robot":
            values = typed(values)
        try:
            # Not strict, because the environment's values are text: "70" is a number, "true" a truth.
            return converted(values, config, strict=False)
        except ValueError as error:
            raw = str(error.__cause__ or error)  # in msgspec's words, which name the place
            told = _with_key(raw, values, config)
            shown = plain(told)
            if (name, told) == ("base", _NO_DRIVE):
                shown = "there is no [base.drive]; say what moves the robot, as deploy/robot.toml does"
            raise ConfigError(
                f"{self.place(name)}: {shown}{_hint(values, config, told) or _form(values, told)}"
            ) from error

    @property
    def is_example(self) -> bool:
        """Nobody has made the source's robot file their own.

        Its name and its network are as they came, and it lacks the wiring, without which base does not arm.
        """
        drive = self.tables.get("base", {}).get("drive")
        is_unwired = isinstance(drive, dict) and drive.keys().isdisjoint(WIRING)
        is_as_it_came = self.tables.get("network", {}).keys() <= _EXAMPLE_NETWORK
        return is_unwired and is_as_it_came and self.tables.get("robot", {}).get("name") == _EXAMPLE

    def place(self, table: str) -> str:
        """Where an error of this table is to be looked for."""
        prefix = f"GIRAFF_{table.upper()}_"
        given = [name for name in self.variables if name.upper().startswith(prefix)]
        variables = f" (with {', '.join(sorted(given))} of the environment)" if given else ""
        return f"{self.where}: table [{table}]{variables}"


class UnknownEntry(NamedTuple):
    """A table or a variable that cannot be used."""

    word: str
    """Its name, small and without GIRAFF_."""
    value: Any
    """What stands there."""
    what: str
    """What is wrong with it."""
    variable: str = ""
    """Empty: it stands in the robot file."""


def robot_file(environment: Mapping[str, str] = os.environ) -> Path:
    """Path of the robot file."""
    given = environment.get("GIRAFF_CONFIG")
    path = Path(given) if given else DEFAULT_FILE
    try:
        is_there = path.is_file() or str(path) == NO_FILE
        place = path.absolute()
    except OSError as error:
        raise ConfigError(f"{path}: cannot be read: {error.strerror}") from error
    if not is_there:
        wanted = "GIRAFF_CONFIG names it" if given else "it is looked for there unless GIRAFF_CONFIG names another"
        raise ConfigError(f"no robot file at {place} ({wanted})")
    return path


def expects_robot_file(environment: Mapping[str, str] = os.environ) -> bool:
    """Whether there is a robot file, or should be one: commands need none, but pass none over."""
    if environment.get("GIRAFF_CONFIG"):
        return True
    try:
        DEFAULT_FILE.lstat()
    except (FileNotFoundError, NotADirectoryError):
        return False
    except OSError:  # one may not look
        return True
    return True


def read(environment: Mapping[str, str] = os.environ, *, with_file: bool = True) -> RawSettings:
    """The robot file and the environment's overrides; the latter alone, if so wanted. Raises ConfigError."""
    filed = _read_file(robot_file(environment)) if with_file else RawSettings("environment", {}, (), ())
    strange, variables = [*filed.strange], []
    for variable, text in sorted(environment.items(), key=_depth):
        if not variable.startswith("GIRAFF_") or variable in _NOT_FIELDS:
            continue
        try:
            _override(filed.tables, variable, text)
        except ConfigError as error:
            strange.append(UnknownEntry(variable.removeprefix("GIRAFF_").lower(), text, str(error), variable))
        else:
            variables.append(variable)
    return RawSettings(filed.where, filed.tables, tuple(strange), tuple(variables))


def _read_file(path: Path) -> RawSettings:
    parsed = _parsed(path)
    if not parsed.keys() <= set(ROBOT_TABLES):
        from giraff_core.toml_kinds import ROBOT_FILE, wrong_kind  # noqa: PLC0415  for what is mistyped, which is seldom

        if wrong := wrong_kind(parsed, ROBOT_FILE):
            raise ConfigError(f"{path}: {wrong}")
    tables, strange = {}, []
    for name, table in parsed.items():
        if name not in ROBOT_TABLES:
            what = f"{path}: unknown table [{name}]{suggestion(name, ROBOT_TABLES)}"
            strange.append(UnknownEntry(name.lower(), table, what))
        elif isinstance(table, dict):
            tables[name] = table
        else:
            what = f"{path}: {name} is a value where the table [{name}] belongs"
            strange.append(UnknownEntry(name, table, what))
    return RawSettings(str(path), tables, tuple(strange), ())


def _depth(item: tuple[str, str]) -> int:
    """A whole table comes before its fields."""
    return item[0].count(_IN_TABLE)


def read_tables(environment: Mapping[str, str] = os.environ, *, with_file: bool = True) -> dict[str, dict[str, Any]]:
    """Their tables, of which each is one that there is; values are not yet checked. Raises ConfigError."""
    return read_known(environment, with_file=with_file).tables


def load(table: str, config: type[ConfigT], environment: Mapping[str, str] = os.environ, **otherwise: str) -> ConfigT:
    """The checked table `table` as a `config`. Its fields' defaults stand for what the file leaves out.

    `otherwise`: values of fields that this caller does not need, for a file that leaves them out.
    """
    given = read_known(environment)
    given.tables[table] = {**otherwise, **given.tables.get(table, {})}
    return given.table(table, config)


def read_known(environment: Mapping[str, str] = os.environ, *, with_file: bool = True) -> RawSettings:
    """The same as `read`. Raises ConfigError where something belongs to no table, too."""
    given = read(environment, with_file=with_file)
    if given.strange:
        raise ConfigError(given.strange[0].what)
    return given


def _parsed(path: Path) -> dict[str, Any]:
    try:
        return parse_toml(path.read_text(encoding="utf-8"))
    except ValueError as error:
        raise ConfigError(f"{path}: not TOML: {plain(error)}") from error
    except OSError as error:
        raise ConfigError(f"{path}: cannot be read: {error.strerror}") from error


def _override(tables: dict[str, dict[str, Any]], variable: str, text: str) -> None:
    """Set what a variable says. Raises ConfigError."""
    table, _, field = variable.removeprefix("GIRAFF_").lower().partition("_")
    if table not in ROBOT_TABLES or not field:
        tables_there = [f"GIRAFF_{table.upper()}_…" for table in ROBOT_TABLES]
        raise ConfigError(f"{variable}: names no field; there are {', '.join(tables_there)} and GIRAFF_CONFIG")
    try:
        put(tables, path_of(variable), _value(variable, text))
    except TypeError as error:
        raise ConfigError(f"{variable}: cannot be set: {error}") from error


def path_of(variable: str) -> tuple[str, ...]:
    """Return the tables and the field that a variable sets: GIRAFF_BASE_DRIVE__MAX_LEVEL is base, drive, max_level."""
    table, _, field = variable.removeprefix("GIRAFF_").lower().partition("_")
    return (table, *field.split(_IN_TABLE))


def put(tables: dict[str, Any], path: tuple[str, ...], value: Any) -> None:
    """Set a value, and make the tables that are missing. Raises TypeError where something else stands there."""
    *above, last = path
    inner: Any = tables
    for name in above:
        inner = inner.setdefault(name, {})
        if not isinstance(inner, dict):
            raise TypeError(f"{name} is no table")
    inner[last] = value


def _hint(values: Mapping[str, Any], config: type[msgspec.Struct], told: str) -> str:
    """Return the word that was meant, for one that does not exist; `told` says in which table it stands."""
    found, unknown = _PLACE.search(told), _UNKNOWN.search(told)
    keys = found[1].split(".") if found else []
    kind: Any = msgspec.inspect.type_info(config)
    inner: Any = values
    for key in keys if unknown else keys[:-1]:
        kind, inner = _type_of(kind, inner, key), inner.get(key)
        if not isinstance(inner, dict):
            return ""
    structs = _structs(kind, inner)
    if unknown:
        names = [field.name for struct in structs for field in struct.fields]
        return suggestion(unknown[1], names)
    known = _words(kind, inner, keys[-1]) if keys else ()
    return suggestion(str(inner.get(keys[-1])), known) if known and inner.get(keys[-1]) not in known else ""


def _form(values: Mapping[str, Any], told: str) -> str:
    """Return the text that stands where `told` wants another type, and how to write it where that is clear."""
    wanted, found = _NO_TEXT.search(told), _PLACE.search(told)
    text: Any = values
    for key in found[1].split(".") if found else ():
        text = text.get(key) if isinstance(text, Mapping) else None
    if wanted is None or not isinstance(text, str):
        return ""
    if wanted[1] == "array":
        parts = [part for part in re.split(r"[,;\s]+", text) if part]
        if found and found[1] == "connect" and not all(map(_is_address, parts or ("",))):
            parts = ["192.168.1.20:7447"]
        return f" ({text!r}); write {msgspec.json.encode(parts).decode()}"
    number = text.strip().replace(",", ".")
    if wanted[1] == "float" and _NUMBER.fullmatch(number):
        return f" ({text!r}); write {float(number)!r}"
    return f" ({text!r})" + (f"; write it like {_EXAMPLES[wanted[1]]}" if wanted[1] in _EXAMPLES else "")


def _is_address(text: str) -> bool:
    try:
        host_and_port(text)
    except ValueError:
        return False
    return True


def _structs(kind: Any, values: Mapping[str, Any]) -> list[msgspec.inspect.StructType]:
    """Return those of a type; where a tag tells several apart, the one that is meant, else all."""
    kinds = kind.types if isinstance(kind, msgspec.inspect.UnionType) else (kind,)
    structs = [each for each in kinds if isinstance(each, msgspec.inspect.StructType)]
    tagged = [each for each in structs if each.tag_field and values.get(each.tag_field) == each.tag]
    return tagged or structs


def _type_of(kind: Any, values: Mapping[str, Any], key: str) -> Any:
    """Return the type of what stands under this key; None: there is no such key."""
    if isinstance(kind, msgspec.inspect.DictType):
        return kind.value_type
    fields = (field for struct in _structs(kind, values) for field in struct.fields)
    return next((field.type for field in fields if field.name == key), None)


def _words(kind: Any, values: Mapping[str, Any], key: str) -> Sequence[str]:
    """Return the words that may stand under this key; none where anything may."""
    tags = [str(each.tag) for each in _structs(kind, {}) if each.tag_field == key and each.cls is not UnknownSensor]
    inner = _type_of(kind, values, key)
    return tags or (tuple(map(str, inner.values)) if isinstance(inner, msgspec.inspect.LiteralType) else ())


def _with_key(told: str, values: Mapping[str, Any], config: type[msgspec.Struct]) -> str:
    """Which of a table of free names it is: msgspec says `$.sensors[...]` of each."""
    field, is_one_of_many, _ = told.partition("`$.")[2].partition("[...]")
    if not is_one_of_many or not isinstance(values.get(field), dict):
        return told
    kind = get_type_hints(config)[field]
    for key, value in values[field].items():
        try:
            msgspec.convert({key: value}, kind, strict=False)
        except msgspec.ValidationError:
            return told.replace(f"{field}[...]", f"{field}.{key}", 1)
    return told


def _value(variable: str, text: str) -> Any:
    """What a variable holds: text, or a list or a table written as in the file: ["a", "b"], { a = 1, b = 2 }."""
    text = text.strip()  # an env file of Windows ends its lines by a carriage return
    if (quoted := _QUOTED.fullmatch(text)) is not None:
        text = quoted[2].strip()
    kind = _WRITTEN_AS_TOML.get(text[:1])
    if kind is None:
        return text
    try:
        values = parse_toml(f"value = {text}")
    except ValueError as error:
        raise ConfigError(f"{variable}: not a {kind} as TOML has it: {error}") from error
    if len(values) > 1:
        raise ConfigError(f"{variable}: not a {kind} as TOML has it: give one value, and nothing behind it")
    return values["value"]


def parse_toml(text: str) -> dict[str, Any]:
    """Raises ValueError, also for what is TOML and would be too much for whoever reads it."""
    try:
        values = tomllib.loads(text.removeprefix("\ufeff"))  # an editor of Windows may begin a file so
    except (ValueError, RecursionError) as error:
        raise ValueError(plain(error)) from error
    _require_moderate(values, _DEEPEST)
    return values


def _require_moderate(value: Any, deepest: int) -> None:
    if deepest == 0:
        raise ValueError(_TOO_DEEP)
    if isinstance(value, int):
        require_sendable(value)
    for inner in value.values() if isinstance(value, dict) else value if isinstance(value, list) else ():
        _require_moderate(inner, deepest - 1)


def suggestion(word: str, known: Sequence[str]) -> str:
    """Which of the known words was meant, as the end of a message."""
    close = near(word, known)
    return f"; did you mean {close[0]!r}?" if close else f"; known are: {', '.join(sorted(known))}"
