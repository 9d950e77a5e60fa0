"""Who tries what he may not, on a machine of the lab, and what has become of it so far."""

import json
import sys
import time
from pathlib import Path
from typing import Any, Final, Literal, NamedTuple, Self

from tests.hosts.lab import NAME, PATIENCE, Lab
from tests.hosts.machine import Machine, kill
from tests.support.waiting import wait

_STRANGER: Final = Path(__file__).with_name("stranger.py")
Does = Literal["drives", "guards", "listens"]


class Told(NamedTuple):
    """What became of an attempt."""

    heard: int
    """Samples of the robot."""
    links: list[str]
    """Locators of their other ends."""


class Attempt:
    """Goes on until the end of its block."""

    def __init__(self, lab: Lab, machine: Machine, config: dict[str, Any], does: Does = "drives") -> None:
        """`config`: Zenoh's. `does`: it says whatever moves a robot, or what guard alone does."""
        self._output = lab.directory / f"attempt-{machine.name}-{time.monotonic_ns()}"
        command = [sys.executable, str(_STRANGER), NAME, json.dumps(config), does]
        with self._output.open("wb") as out, self._output.with_suffix(".log").open("wb") as log:
            self._process = machine.start(command, stdout=out, stderr=log)

    def told(self) -> Told:
        """The newest; waits until its session is open."""
        wait(self._lines, PATIENCE, what=lambda: self._output.with_suffix(".log").read_text())
        return Told(**json.loads(self._lines()[-1]))

    def hears(self, samples: int) -> None:
        """Wait for so many."""
        wait(lambda: self.told().heard >= samples, PATIENCE, what=lambda: f"{samples} samples; {self.told()}")

    def tells_anew(self) -> Told:
        """What it tells of a moment after this call."""
        before = len(self._lines())
        wait(lambda: len(self._lines()) > before + 1, PATIENCE, what="its next line")
        return self.told()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        ended = self._process.poll()
        kill(self._process)
        assert ended is None, self._output.with_suffix(".log").read_text()

    def _lines(self) -> list[bytes]:
        return self._output.read_bytes().rpartition(b"\n")[0].splitlines()
