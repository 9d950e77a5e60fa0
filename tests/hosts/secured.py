"""What a technician does to three hosts that are down, for a network with certificates."""

import os
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any, Final

from tests.hosts.clone import clone
from tests.hosts.lab import NUMBERS, Lab, address

_CONTAINERS_USER: Final = 1000
_ACCESS: Final = """
[network.access]
robot = ["robot"]
viewers = ["desk"]
operators = { laptop = ["joystick"] }
"""


def make_keys(lab: Lab) -> Path:
    """The technician's folder."""
    folder = lab.directory / "keys"
    _technician("keys", "init", "--folder", str(folder))
    for host in NUMBERS:
        _technician("keys", "host", host, address(host), "--folder", str(folder))
    return folder


def secure(lab: Lab, keys: Path) -> None:
    """All of them, and the robot gets a sentry."""
    lab.do_without_multicast("secured", profiles="robot,sentry")
    for host in NUMBERS:
        here = lab.clone(host) / "deploy"
        _copy(keys / host, here / "keys")
        with (here / "robot.toml").open("a") as robot_file:
            robot_file.write(_ACCESS)


def open_again(lab: Lab) -> None:
    """As they were cloned."""
    for host in NUMBERS:
        clone(lab.clone(host))
        lab.write_env(host)


def known_as(keys: Path, host: str) -> dict[str, Any]:
    """The table `[network]` of who has that host's certificate."""
    access = tomllib.loads(_ACCESS)["network"]["access"]
    return {"mode": "secured", "connect": [address("robot")], "keys": str(keys / host), "access": access}


def _technician(*words: str) -> None:
    subprocess.run([sys.executable, "-m", "giraff_cli", *words], check=True, capture_output=True)


def _copy(bundle: Path, place: Path) -> None:
    """As docs/keys.md has it for containers."""
    place.mkdir(exist_ok=True)
    for file in bundle.iterdir():
        copy = place / file.name
        copy.write_bytes(file.read_bytes())
        copy.chmod(0o600)
        os.chown(copy, _CONTAINERS_USER, _CONTAINERS_USER)
