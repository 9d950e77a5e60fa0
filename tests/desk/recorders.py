"""`giraff record` and `giraff play` beside a running robot."""

from __future__ import annotations

import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import psutil

from tests.system.elsewhere import GIRAFF
from tests.system.robot import ProcessRobot


@contextmanager
def giraff_process(robot: ProcessRobot, *words: str, **popen: Any) -> Iterator[subprocess.Popen[str]]:
    """A command on the robot's host, which ends with the block."""
    command = [str(GIRAFF), *words]
    streams: dict[str, Any] = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with subprocess.Popen(command, env=robot.environment, cwd=robot.directory, **streams | popen) as process:
        try:
            yield process
        finally:
            process.kill()


def records(process: subprocess.Popen[str], path: Path) -> None:
    """Wait until the first samples are on disk."""
    deadline = time.monotonic() + 20.0
    while not path.exists() or path.stat().st_size < 20_000:
        assert process.poll() is None
        assert time.monotonic() < deadline
        time.sleep(0.05)


def share_of_a_core(process: psutil.Process, seconds: float) -> float:
    """That a process takes from now on."""
    before, began = sum(process.cpu_times()[:2]), time.monotonic()
    time.sleep(seconds)
    return float(sum(process.cpu_times()[:2]) - before) / (time.monotonic() - began)
