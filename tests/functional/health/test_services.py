"""What each service counts as its own fault: a board that is not there, and not that nobody else is."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from giraff_cli.watcher import free_port
from giraff_sim.board import ROOT
from tests.functional.health.answering import check

Start = Callable[..., None]


@pytest.fixture
def start(tmp_path: Path) -> Iterator[Start]:
    """Starts a service, alone, and waits until it can be asked."""
    started: list[subprocess.Popen[bytes]] = []

    def run(service: str, **variables: str) -> None:
        given = {
            "GIRAFF_CONFIG": str(ROOT / "deploy" / "robot.toml"),
            "GIRAFF_NETWORK_LOCAL": "true",
            "GIRAFF_NETWORK_RENDEZVOUS": f"127.0.0.1:{free_port()}",
            "RUNTIME_DIRECTORY": str(tmp_path),
            "STATE_DIRECTORY": str(tmp_path),
        }
        command = [sys.executable, "-m", f"giraff_{service}"]
        with (tmp_path / "log").open("wb") as log:
            started.append(subprocess.Popen(command, env=os.environ | given | variables, stderr=log))
        deadline = time.monotonic() + 20.0
        while not (tmp_path / f"{service}.sock").exists():
            assert started[-1].poll() is None, (tmp_path / "log").read_text()
            assert time.monotonic() < deadline, "it does not start"
            time.sleep(0.02)

    yield run
    for process in started:
        process.kill()
        process.wait()


@pytest.mark.parametrize("service", ["base", "ranger", "joystick"])
def test_without_its_board_a_service_is_not_well_and_says_why(start: Start, tmp_path: Path, service: str) -> None:
    port = str(tmp_path / "port")
    start(service, **{f"GIRAFF_{service.upper()}_PORT": port})
    assert check(tmp_path, service) == (
        1,
        f"{port}: no such port; plug the board in, or correct `port` in the robot file\n",
    )


@pytest.mark.parametrize("service", ["guard", "odometry"])
def test_alone_in_the_world_a_service_is_well(start: Start, tmp_path: Path, service: str) -> None:
    start(service)
    time.sleep(1.5)  # until it has noticed
    code, words = check(tmp_path, service)
    assert code == 0
    assert ("no wheels from base" in words) is (service == "odometry")
