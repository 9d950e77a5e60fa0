"""The `giraff` command on any machine: no robot file is at hand, and one endpoint is known."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from tests.support.process_robot import PATIENCE, ProcessRobot
from tests.support.zygote import run_giraff

GIRAFF = Path(sys.executable).with_name("giraff")

ALONE = {"GIRAFF_NETWORK_MODE": "fixed"}
"""Commands for two robots that look for others would find each other, and make their robots' networks one."""


def clean(environment: dict[str, str]) -> dict[str, str]:
    """Without any setting of a robot."""
    return {name: value for name, value in environment.items() if not name.startswith("GIRAFF_")}


def giraff(robot: ProcessRobot, *words: str, name: str | None = "sim-test") -> subprocess.CompletedProcess[str]:
    """What it says of `robot`. `name`: as it is given on the command line; None: it is not."""
    nowhere = robot.directory / "nowhere"
    nowhere.mkdir(exist_ok=True)
    options = ["--connect", robot.environment["GIRAFF_NETWORK_RENDEZVOUS"]]
    options += [] if name is None else ["--robot", name]
    return run_giraff((*words, *options), nowhere, clean(dict(os.environ)) | ALONE, PATIENCE)


@contextmanager
def watching(robot: ProcessRobot, *words: str, **popen: Any) -> Iterator[subprocess.Popen[str]]:
    """A watch of the robot, into a pipe."""
    streams: dict[str, Any] = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    command = [str(GIRAFF), "watch", *words]
    with subprocess.Popen(command, env=robot.environment, cwd=robot.directory, **streams | popen) as process:
        try:
            yield process
        finally:
            process.kill()


def line_that(process: subprocess.Popen[str], told: Callable[[str], bool], most: int = 100) -> str:
    """The next line, one a second, of which that is so."""
    assert process.stdout is not None
    lines = []
    for line in process.stdout:
        lines.append(line)
        if told(line):
            return line
        if len(lines) == most:
            break
    raise AssertionError("".join(lines))


def end(process: subprocess.Popen[str], number: signal.Signals) -> float:
    """How long it took to end well, s."""
    began = time.monotonic()
    process.send_signal(number)
    assert process.wait(PATIENCE) == 0
    assert process.stderr is not None
    assert process.stderr.read() == ""
    return time.monotonic() - began
