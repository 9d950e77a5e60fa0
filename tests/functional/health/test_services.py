"""What each service counts as its own fault: a board that is not there, and not that nobody else is."""

import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from giraff_sim.board import ROOT
from giraff_tools.network.ports import free_port
from tests.functional.health.answering import check
from tests.support.waiting import wait

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
        command = [sys.executable, "-m", "giraff_node", service]
        with (tmp_path / "log").open("wb") as log:
            started.append(subprocess.Popen(command, env=os.environ | given | variables, stderr=log))

        def is_there() -> bool:
            assert started[-1].poll() is None, (tmp_path / "log").read_text()
            return (tmp_path / f"{service}.sock").exists()

        wait(is_there, 60.0, what="its start")

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


def test_alone_in_the_world_a_service_is_well(start: Start, tmp_path: Path) -> None:
    """Which it is still once it has noticed."""
    start("guard")
    start("odometry")
    wait(lambda: "no wheels from base" in check(tmp_path, "odometry")[1], 60.0)
    assert [check(tmp_path, service)[0] for service in ("guard", "odometry")] == [0, 0]
