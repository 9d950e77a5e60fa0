"""The README's example: any machine subscribes with plain zenoh and msgpack, and no code of ours."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from giraff_schemas.topics import ODOM
from giraff_sim.board import ROOT
from tests.support.process_robot import PATIENCE, ProcessRobot

_CONNECT = re.compile(r"# (config\.insert_json5\(.*)tcp/[^\"]*(\"\]'\))  # .*")


def example(endpoint: str) -> str:
    """The README's Python, told where the robot is as its comment says."""
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(), flags=re.DOTALL)
    assert len(blocks) == 1
    assert "giraff_" not in blocks[0], "the example may use no code of ours"
    code, replaced = _CONNECT.subn(rf"\1tcp/{endpoint}\2", blocks[0])
    assert replaced == 1
    assert len(code.strip().splitlines()) <= 10
    return code


def test_the_example_prints_the_odometry(robot: ProcessRobot, tmp_path: Path) -> None:
    robot.observer.follow(ODOM)
    robot.drive_forward()
    robot.hold(0.0, 0.0)
    robot.wait("standing", lambda: (odom := robot.observer.newest(ODOM)) and odom.linear_x == 0.0, PATIENCE)
    script = tmp_path / "listen.py"
    script.write_text(example(robot.environment["GIRAFF_NETWORK_RENDEZVOUS"]))
    printed = tmp_path / "printed"
    with printed.open("wb") as output:
        listener = subprocess.Popen([sys.executable, "-I", str(script)], stdout=output)
    try:
        robot.wait("odometry on the listener's screen", lambda: printed.read_text().count("\n") > 10, PATIENCE)
    finally:
        listener.kill()
        listener.wait()
    told = [float(word) for word in re.findall(r"-?\d+\.\d+", printed.read_text().splitlines()[10])]
    odometry = robot.observer.newest(ODOM)
    assert odometry is not None
    assert told == pytest.approx([odometry.x, odometry.y, odometry.yaw], abs=0.011)
