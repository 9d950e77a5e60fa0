"""A table of the robot file, as it was when something was recorded."""

from typing import TypeVar

import msgspec

from giraff_mcap.reading import Recording, RecordingError
from giraff_node.config.robot_file import ConfigError, load
from giraff_schemas.checks import converted

ConfigT = TypeVar("ConfigT", bound=msgspec.Struct)


def table_of(recording: Recording, table: str, config: type[ConfigT]) -> ConfigT:
    """As it was then; else as the robot file at hand has it. Raises RecordingError; ConfigError where there is none."""
    tables = recording.tables()
    if table not in tables and "tables" not in recording.about:
        try:
            return load(table, config)
        except ConfigError as error:
            raise ConfigError(f"{recording.path} was recorded where its robot file was not; {error}") from error
    try:
        return converted(tables.get(table, {}), config, strict=False)
    except ValueError as error:
        raise RecordingError(
            f"{recording.path}: table [{table}] of the robot file in it is not one of this version: {error}"
        ) from error
