"""The examples of `giraff_client` as people run them, beside the simulated robot."""

import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, Final

from giraff_schemas.topics import LEASE
from tests.support.examples import EXAMPLES
from tests.support.process_robot import ProcessRobot

PATIENCE: Final = 60.0
"""s"""


def is_free(robot: ProcessRobot) -> bool:
    lease = robot.observer.newest(LEASE)
    return lease is not None and not lease.holder


@contextmanager
def example(robot: ProcessRobot, name: str, *words: str) -> Iterator[subprocess.Popen[str]]:
    """One that runs, and ends with the block."""
    command = [sys.executable, str(EXAMPLES / name), *words]
    streams: dict[str, Any] = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    with subprocess.Popen(command, text=True, env=robot.environment, cwd=robot.directory, **streams) as process:
        try:
            yield process
        finally:
            process.kill()


def first_line(robot: ProcessRobot, name: str, x: float, y: float, *words: str, begins: str = "") -> str:
    """Start an example at this place and return its first line that begins so; again, where it loses the robot."""
    said: list[str] = []

    def says_it() -> bool:
        robot.wait("nobody who drives", lambda: is_free(robot), PATIENCE)
        robot.simulator.place(x, y)
        with example(robot, name, *words) as process:
            assert process.stdout is not None
            assert process.stderr is not None
            said.append(next((line for line in process.stdout if line.startswith(begins)), ""))
            if said[-1]:
                return True
            why = process.stderr.read()
            assert "giraff_client.errors." in why, why
            return False

    robot.wait(name, says_it, PATIENCE)
    return said[-1]
