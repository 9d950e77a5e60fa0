"""Gains on trial: they are in the robot file while a second drive judges them, and stay only where it is better."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Final

from giraff_cli.robot_file import Value, before_today, record
from giraff_cli.terminal.human import Human
from giraff_node.process.state import write_file_durably

TABLE: Final = "base.drive.speed_control"


class Trial:
    """The robot file with other gains."""

    def __init__(self, path: Path, found: Mapping[str, Value]) -> None:
        """Raises RobotFileError."""
        self.copy = record(path, TABLE, found, kept_as=before_today())
        """The file as it was."""
        self.stays = False
        """The new gains are better."""


@contextmanager
def on_trial(human: Human, path: Path, found: Mapping[str, Value]) -> Iterator[Trial]:
    """Put the file back at the end, whatever ends it, unless its gains stay. Raises RobotFileError."""
    trial = Trial(path, found)
    written = path.read_bytes()
    try:
        yield trial
    finally:
        if not trial.stays:
            try:
                _put_back(path, trial.copy, written)
            except OSError as error:
                human.tell(f"The gains on trial are still in {path}: {error}. It was before: {trial.copy}.")
            else:
                human.tell(f"{path} is as it was. If base has been restarted, restart it once more, at rest.")


def _put_back(path: Path, copy: Path | None, written: bytes) -> None:
    if copy is None or path.read_bytes() != written:
        raise OSError("it was changed meanwhile")
    write_file_durably(path, copy.read_bytes())
    copy.unlink()
