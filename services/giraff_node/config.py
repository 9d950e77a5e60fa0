"""Strict configuration: the robot file (TOML, one table a service), then the environment.

The file is $GIRAFF_CONFIG, else `deploy/robot.toml` below the working directory. A variable GIRAFF_<TABLE>_<FIELD>
(GIRAFF_BASE_PORT, GIRAFF_ROBOT_NAME) overrides one field. Anything unknown is an error that suggests the right word.
"""

from __future__ import annotations

import difflib
import math
import os
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final, TypeVar

import msgspec

ConfigT = TypeVar("ConfigT", bound=msgspec.Struct)

_MOST: Final = 1e9
"""Of any unit: as seconds it is 30 years and fits into 64 bits of ns; what is squared and summed stays finite."""
_AT_MOST: Final = f", {_MOST:g} at most"

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


class ConfigError(Exception):
    """A robot file or a variable that cannot be used. The message names where and the way out."""


def robot_file(environment: Mapping[str, str] = os.environ) -> Path:
    """Path of the robot file."""
    given = environment.get("GIRAFF_CONFIG")
    path = Path(given) if given else DEFAULT_FILE
    if not path.is_file():
        wanted = "GIRAFF_CONFIG names it" if given else "it is looked for there unless GIRAFF_CONFIG names another"
        raise ConfigError(f"no robot file at {path.absolute()} ({wanted})")
    return path


def read_tables(environment: Mapping[str, str] = os.environ) -> dict[str, dict[str, Any]]:
    """The robot file's tables with the environment's overrides; values are not yet checked."""
    path = robot_file(environment)
    try:
        tables = tomllib.loads(path.read_text())
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ConfigError(f"{path}: not TOML: {error}") from error
    except OSError as error:
        raise ConfigError(f"{path}: cannot be read: {error.strerror}") from error
    for name, table in tables.items():
        if name not in TABLES:
            raise ConfigError(f"{path}: unknown table [{name}]{_suggestion(name, TABLES)}")
        if not isinstance(table, dict):
            raise ConfigError(f"{path}: {name} is a value where the table [{name}] belongs")
    for name, table in overrides(environment).items():
        tables.setdefault(name, {}).update(table)
    return tables


def overrides(environment: Mapping[str, str] = os.environ) -> dict[str, dict[str, Any]]:
    """What the environment alone says, by table; values are not yet checked."""
    tables: dict[str, dict[str, Any]] = {}
    for variable, value in environment.items():
        if not variable.startswith("GIRAFF_") or variable in _NOT_FIELDS:
            continue
        table_name, _, field = variable.removeprefix("GIRAFF_").lower().partition("_")
        if table_name not in TABLES or not field:
            tables_there = [f"GIRAFF_{table.upper()}_…" for table in TABLES]
            raise ConfigError(f"{variable}: names no field; there are {', '.join(tables_there)} and GIRAFF_CONFIG")
        tables.setdefault(table_name, {})[field] = _value(variable, value)
    return tables


def load(table: str, config: type[ConfigT], environment: Mapping[str, str] = os.environ) -> ConfigT:
    """The checked table `table` as a `config`. Its fields' defaults stand for what the file leaves out."""
    values = read_tables(environment).get(table, {})
    given = [name for name in environment if name.upper().startswith(f"GIRAFF_{table.upper()}_")]
    try:
        # Not strict, because the environment's values are text: "70" is a number, "true" a truth.
        return msgspec.convert(values, config, strict=False)
    except msgspec.ValidationError as error:
        fields = [field.name for field in msgspec.structs.fields(config)]
        unknown = [name for name in values if name not in fields]
        hint = _suggestion(unknown[0], fields) if unknown else ""
        variables = f" (with {', '.join(sorted(given))} of the environment)" if given else ""
        raise ConfigError(f"{robot_file(environment)}: table [{table}]{variables}: {error}{hint}") from error


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


def _value(variable: str, text: str) -> Any:
    """What a variable holds: text, or a list or a table written as in the file: ["a", "b"], { a = 1, b = 2 }."""
    kind = _WRITTEN_AS_TOML.get(text[:1])
    if kind is None:
        return text
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError as error:
        raise ConfigError(f"{variable}: not a {kind} as TOML has it: {error}") from error


def _suggestion(word: str, known: list[str] | tuple[str, ...]) -> str:
    close = difflib.get_close_matches(word, known, n=1)
    return f"; did you mean {close[0]!r}?" if close else f"; known are: {', '.join(sorted(known))}"
