"""A service on a secured network tells of keys that are about to fail it, by its log and its health."""

import os
import signal
import subprocess
import sys
import time
from datetime import timedelta
from pathlib import Path

import pytest

from giraff_setup.keys.manage import now
from giraff_sim.board import ROOT
from giraff_tools.network.ports import free_port
from tests.functional.node.peers import SERVICE
from tests.unit.keys.folders import DAY, authority, bundle

ACCESS = """
[network.access]
robot = ["robot"]
"""


def said(tmp_path: Path, robot: Path, wanted: str) -> str:
    """What a service with these keys logs, until it says that."""
    (tmp_path / "robot.toml").write_text((ROOT / "deploy" / "robot.toml").read_text() + ACCESS)
    environment = os.environ | {
        "GIRAFF_CONFIG": str(tmp_path / "robot.toml"),
        "GIRAFF_NETWORK_MODE": "secured",
        "GIRAFF_NETWORK_KEYS": str(robot),
        "GIRAFF_NETWORK_LOCAL": "true",
        "GIRAFF_NETWORK_RENDEZVOUS": f"127.0.0.1:{free_port()}",
    }
    with (tmp_path / "log").open("wb") as log:
        process = subprocess.Popen([sys.executable, str(SERVICE), "talker"], env=environment, stdout=log, stderr=log)
    deadline = time.monotonic() + 60.0
    while wanted not in (tmp_path / "log").read_text() and process.poll() is None and time.monotonic() < deadline:
        time.sleep(0.05)
    process.send_signal(signal.SIGTERM)
    assert process.wait(timeout=60.0) == 0, (tmp_path / "log").read_text()
    return (tmp_path / "log").read_text()


@pytest.mark.parametrize(
    ("age", "word"),
    [
        (71 * DAY, "the keys of robot expire on"),
        (100 * DAY + timedelta(minutes=1), "the keys of robot have expired, no link comes about"),
    ],
)
def test_it_warns_of_keys_that_expire_and_goes_on(tmp_path: Path, age: timedelta, word: str) -> None:
    made = now() - age
    robot = bundle(authority(tmp_path / "keys", made), "robot", made, days=100)
    log = said(tmp_path, robot, word)
    assert word in log
    assert "giraff keys host robot --renew" in log
    assert log.count("the keys of robot") == 1, "once, not at each turn"


def test_it_says_nothing_of_good_keys(tmp_path: Path) -> None:
    log = said(tmp_path, bundle(authority(tmp_path / "keys", now()), "robot", now()), "instance")
    assert "the keys of" not in log
