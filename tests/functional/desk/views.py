"""`giraff view` on the robot's host, without a screen."""

import contextlib
import os
import signal
import subprocess
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Protocol

import psutil

from tests.support.elsewhere import GIRAFF
from tests.support.waiting import wait


class Place(Protocol):
    """A place at which the command is called: beside a robot, or at a desk."""

    directory: Path

    @property
    def environment(self) -> Mapping[str, str]: ...


def view(place: Place, *words: str, timeout: float = 200.0) -> subprocess.CompletedProcess[str]:
    """The command, once it has ended: with more patience than it has itself with a slow viewer."""
    return subprocess.run(
        [str(GIRAFF), "view", *words],
        cwd=place.directory,
        env=screenless(place),
        check=False,
        capture_output=True,
        text=True,
        timeout=timeout,
    )


def screenless(place: Place) -> dict[str, str]:
    return {name: value for name, value in place.environment.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}


@contextlib.contextmanager
def viewing(place: Place, *words: str) -> Iterator[subprocess.Popen[str]]:
    """The command, while it goes on; it and what it has started are ended with the block."""
    command = [str(GIRAFF), "view", *words]
    streams: dict[str, Any] = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with subprocess.Popen(command, cwd=place.directory, env=screenless(place), **streams) as process:
        try:
            yield process
        finally:
            started = viewers_of(process) if process.poll() is None else []
            process.kill()
            for each in started:
                os.killpg(each.pid, signal.SIGKILL)


def viewers_of(process: subprocess.Popen[str]) -> list[psutil.Process]:
    """What a view has started; not what is about to be."""
    return [child for child in psutil.Process(process.pid).children(recursive=True) if child.name() == "rerun"]


def await_viewer(process: subprocess.Popen[str]) -> psutil.Process:
    wait(lambda: process.poll() is not None or viewers_of(process), 60.0, what="no viewer was started")
    assert process.poll() is None, process.communicate()
    return viewers_of(process)[0]
