"""A RoboClaw on a pseudo terminal, in real time: the model of the simulated world, which keeps a record of its own."""

import json
import subprocess
from pathlib import Path
from typing import Any, Final, Self

from giraff_sim.board import BUILD
from tests.support.waiting import wait

PROGRAM: Final = BUILD / "host" / "roboclaw_terminal"
PATIENCE: Final = 60.0
"""s for whatever comes about."""

Row = dict[str, Any]


class Terminal:
    """The controller, its motors and what happens to it, as firmware/host/controller_terminal.c lists it."""

    def __init__(self, directory: Path) -> None:
        self.link = directory / "tty"
        self._path = directory / "record"
        with self._path.open("wb") as record:
            self._process = subprocess.Popen([PROGRAM, self.link], stdin=subprocess.PIPE, stdout=record)
        self._record = self._path.open()
        self._part = ""
        self.rows: list[Row] = []
        """As far as `look` has read them."""

    def __enter__(self) -> Self:
        wait(self.link.is_symlink, PATIENCE, what="no terminal")
        return self

    def __exit__(self, *_: object) -> None:
        assert self._process.stdin is not None
        self._process.stdin.close()  # ends it
        self._process.wait()
        self._record.close()

    def look(self) -> list[Row]:
        """Return the rows of the record so far."""
        *lines, self._part = (self._part + self._record.read()).split("\n")
        self.rows += map(json.loads, lines)
        return self.rows

    def tell(self, words: str) -> Row:
        """Let something happen; return the row of the record that says so."""
        assert self._process.stdin is not None
        known = len(self.look())
        self._process.stdin.write(f"{words}\n".encode())
        self._process.stdin.flush()
        found: list[Row] = []

        def is_told() -> bool:
            found.extend(row for row in self.look()[known:] if "duty" not in row)
            return bool(found)

        wait(is_told, PATIENCE, what=f"{words}: not told", every=0.001)
        assert "unknown" not in found[0], words
        return found[0]

    def truth(self) -> Row:
        """Return its state. `late` is the longest that it has stood still since it was asked last, in s."""
        truth: Row = self.tell("truth")["truth"]
        return truth

    def duties(self, since: float, until: float) -> list[tuple[float, list[int]]]:
        """Return the duties in this time, s: when each began, and the one that was there first."""
        rows = [(row["t"], row["duty"]) for row in self.look() if "duty" in row and row["t"] <= until]
        before = [row for row in rows if row[0] <= since][-1:] or [(since, [0, 0])]
        return [(since, before[0][1]), *(row for row in rows if row[0] > since)]
