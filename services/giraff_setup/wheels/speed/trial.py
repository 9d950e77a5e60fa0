"""Gains on trial: they are in the robot file while a second drive judges them, and stay only where it is better."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Final, Self

from giraff_node.process.state import write_file_durably
from giraff_tools.robot_file import Value, before_today, record
from giraff_tools.terminal.human import Human

TABLE: Final = "base.drive.speed_control"


class Trial:
    """The robot file with other gains. It is put back at the end, whatever ends it, unless its gains stay."""

    def __init__(self, human: Human, path: Path, found: Mapping[str, Value]) -> None:
        """Write the gains. Raises RobotFileError."""
        self._human, self._path = human, path
        self.copy = record(path, TABLE, found, kept_as=before_today())
        """The file as it was."""
        self._written = path.read_bytes()
        self.stays = False
        """The new gains are better."""
        self.is_settled = False
        """At the end the file has the better gains, and no others."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.is_settled = self.stays
        if self.stays:
            return
        why = "it was changed meanwhile"
        try:
            if self.copy is not None and self._path.read_bytes() == self._written:
                write_file_durably(self._path, self.copy.read_bytes())
                self.copy.unlink()
                self.is_settled = True
        except OSError as error:
            why = str(error)
        self._human.show(
            f"The gains on trial are still in {self._path}: {why}. It was before: {self.copy}."
            if not self.is_settled
            else f"{self._path} is as it was. If base has been restarted, restart it once more, at rest."
        )
