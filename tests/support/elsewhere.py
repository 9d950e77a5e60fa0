"""The `giraff` command on any machine: no robot file is at hand, no variable is set, one endpoint is known."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from tests.support.process_robot import ProcessRobot

GIRAFF = Path(sys.executable).with_name("giraff")


def clean(environment: dict[str, str]) -> dict[str, str]:
    """Without any setting of a robot."""
    return {name: value for name, value in environment.items() if not name.startswith("GIRAFF_")}


def giraff(robot: ProcessRobot, *words: str, name: str | None = "sim-test") -> subprocess.CompletedProcess[str]:
    """What it says of `robot`. `name`: as it is given on the command line; None: it is not."""
    nowhere = robot.directory / "nowhere"
    nowhere.mkdir(exist_ok=True)
    options = ["--connect", robot.environment["GIRAFF_NETWORK_RENDEZVOUS"]]
    options += [] if name is None else ["--robot", name]
    command = [str(GIRAFF), *words, *options]
    return subprocess.run(
        command, cwd=nowhere, env=clean(dict(os.environ)), check=False, capture_output=True, text=True, timeout=60.0
    )
