"""Strict configuration: the robot file (TOML, one table a service), then the environment.

The file is $GIRAFF_CONFIG, else `deploy/robot.toml` below the working directory; /dev/null is an empty one. A variable
GIRAFF_<TABLE>_<FIELD> (GIRAFF_BASE_PORT, GIRAFF_ROBOT_NAME) overrides one field. Anything unknown is an error that
suggests the right word.
"""

from __future__ import annotations

import difflib
import os
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, NamedTuple, TypeVar

import msgspec
import msgspec.inspect

ConfigT = TypeVar("ConfigT", bound=msgspec.Struct)

TABLES = (
    "robot",
    "network",
    "joystick",
    "keyboard",
    "base",
    "ranger",
    "odometry",
    "guard",
    "recorder",
    "sentry",
    "gateway",
    "router",
    "sim",
)
_NOT_FIELDS = ("GIRAFF_CONFIG",)
_WRITTEN_AS_TOML: Final = {"[": "list", "{": "table"}
DEFAULT_FILE = Path("deploy/robot.toml")
"""The robot file below the working directory, where GIRAFF_CONFIG names no other."""
NO_FILE: Final = os.devnull
"""What GIRAFF_CONFIG names where no file is to count, wherever one may be: as a robot file it is empty."""


class ConfigError(Exception):
    """A robot file or a variable that cannot be used. The message names where and the way out."""


@dataclass(frozen=True)
class Given:
    """What robot file and environment say. Values are not yet checked."""

    where: str
    """The robot file; "environment" where there is none."""
    tables: dict[str, dict[str, Any]]
    strange: tuple[Strange, ...]
    """What belongs to no table, in the order in which it was met."""
    variables: tuple[str, ...]
    """Those of the environment that have set a field."""

    def table(self, name: str, config: type[ConfigT]) -> ConfigT:
        """The checked table as a `config`, whose fields' defaults stand for what is left out. Raises ConfigError."""
        values = self.tables.get(name, {})
        try:
            # Not strict, because the environment's values are text: "70" is a number, "true" a truth.
            return msgspec.convert(values, config, strict=False)
        except msgspec.ValidationError as error:
            raise ConfigError(f"{self.place(name)}: {error}{_hint(values, config, str(error))}") from error

    def place(self, table: str) -> str:
        """Where an error of this table is to be looked for."""
        given = [name for name in self.variables if name.upper().startswith(f"GIRAFF_{table.upper()}_")]
        variables = f" (with {', '.join(sorted(given))} of the environment)" if given else ""
        return f"{self.where}: table [{table}]{variables}"


class Strange(NamedTuple):
    """A table or a variable that cannot be used."""

    word: str
    """Its name, small and without GIRAFF_."""
    fields: tuple[str, ...]
    """What stands in such a table."""
    what: str
    """What is wrong with it."""


def robot_file(environment: Mapping[str, str] = os.environ) -> Path:
    """Path of the robot file."""
    given = environment.get("GIRAFF_CONFIG")
    path = Path(given) if given else DEFAULT_FILE
    try:
        is_there = path.is_file() or str(path) == NO_FILE
    except OSError as error:
        raise ConfigError(f"{path}: cannot be read: {error.strerror}") from error
    if not is_there:
        wanted = "GIRAFF_CONFIG names it" if given else "it is looked for there unless GIRAFF_CONFIG names another"
        raise ConfigError(f"no robot file at {path.absolute()} ({wanted})")
    return path


def is_at_hand(environment: Mapping[str, str] = os.environ) -> bool:
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


def read(environment: Mapping[str, str] = os.environ, *, with_file: bool = True) -> Given:
    """The robot file and the environment's overrides; the latter alone, if so wanted. Raises ConfigError."""
    tables: dict[str, dict[str, Any]] = {}
    strange = []
    where = "environment"
    if with_file:
        path = robot_file(environment)
        where = str(path)
        for name, table in _parsed(path).items():
            if name not in TABLES:
                fields = tuple(table) if isinstance(table, dict) else ()
                what = f"{path}: unknown table [{name}]{suggestion(name, TABLES)}"
                strange.append(Strange(name.lower(), fields, what))
            elif isinstance(table, dict):
                tables[name] = table
            else:
                what = f"{path}: {name} is a value where the table [{name}] belongs"
                strange.append(Strange(name, (), what))
    variables = []
    for variable, text in environment.items():
        if not variable.startswith("GIRAFF_") or variable in _NOT_FIELDS:
            continue
        try:
            table_name, field, value = _override(variable, text)
        except ConfigError as error:
            strange.append(Strange(variable.removeprefix("GIRAFF_").lower(), (), str(error)))
        else:
            variables.append(variable)
            tables.setdefault(table_name, {})[field] = value
    return Given(where, tables, tuple(strange), tuple(variables))


def read_tables(environment: Mapping[str, str] = os.environ, *, with_file: bool = True) -> dict[str, dict[str, Any]]:
    """Their tables, of which each is one that there is; values are not yet checked. Raises ConfigError."""
    return _known(read(environment, with_file=with_file)).tables


def load(table: str, config: type[ConfigT], environment: Mapping[str, str] = os.environ) -> ConfigT:
    """The checked table `table` as a `config`. Its fields' defaults stand for what the file leaves out."""
    return _known(read(environment)).table(table, config)


def _known(given: Given) -> Given:
    if given.strange:
        raise ConfigError(given.strange[0].what)
    return given


def _parsed(path: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(path.read_text())
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ConfigError(f"{path}: not TOML: {error}") from error
    except OSError as error:
        raise ConfigError(f"{path}: cannot be read: {error.strerror}") from error


def _override(variable: str, text: str) -> tuple[str, str, Any]:
    """Table, field and value. Raises ConfigError."""
    table, _, field = variable.removeprefix("GIRAFF_").lower().partition("_")
    if table not in TABLES or not field:
        tables_there = [f"GIRAFF_{table.upper()}_…" for table in TABLES]
        raise ConfigError(f"{variable}: names no field; there are {', '.join(tables_there)} and GIRAFF_CONFIG")
    return table, field, _value(variable, text)


def _hint(values: Mapping[str, Any], config: type[msgspec.Struct], told: str) -> str:
    """The word that was meant, for one that there is not."""
    info = msgspec.inspect.type_info(config)
    assert isinstance(info, msgspec.inspect.StructType)  # noqa: S101  it is one
    fields = {field.name: field.type for field in info.fields}
    for name, value in values.items():
        if name not in fields:
            return suggestion(name, tuple(fields))
        kind = fields[name]
        if isinstance(kind, msgspec.inspect.LiteralType) and value not in kind.values and f"`$.{name}`" in told:
            return suggestion(str(value), tuple(map(str, kind.values)))
    return ""


def _value(variable: str, text: str) -> Any:
    """What a variable holds: text, or a list or a table written as in the file: ["a", "b"], { a = 1, b = 2 }."""
    kind = _WRITTEN_AS_TOML.get(text[:1])
    if kind is None:
        return text
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError as error:
        raise ConfigError(f"{variable}: not a {kind} as TOML has it: {error}") from error


def suggestion(word: str, known: Sequence[str]) -> str:
    """Which of the known words was meant, as the end of a message."""
    close = difflib.get_close_matches(word, known, n=1)
    return f"; did you mean {close[0]!r}?" if close else f"; known are: {', '.join(sorted(known))}"
