"""The README's example: any machine subscribes with plain zenoh and msgpack, and no code of ours."""

import re
import subprocess
import sys
from pathlib import Path

from giraff_sim.board import ROOT
from tests.support.process_robot import PATIENCE, ProcessRobot

_CONNECT = re.compile(r"# (config\.insert_json5\(.*)tcp/[^\"]*(\"\]'\))  # .*")


_SILENT = 'config.insert_json5("scouting/multicast/enabled", "false")'


def example(endpoint: str) -> str:
    """The README's Python, told where the robot is as its comment says, and to look for no other on this machine."""
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(), flags=re.DOTALL)
    assert len(blocks) == 1
    assert "giraff_" not in blocks[0], "the example may use no code of ours"
    assert len(blocks[0].strip().splitlines()) <= 10
    code, replaced = _CONNECT.subn(rf"\1tcp/{endpoint}\2\n{_SILENT}", blocks[0])
    assert replaced == 1
    return code


def test_the_example_prints_the_odometry(robot: ProcessRobot, tmp_path: Path) -> None:
    robot.wait("a pose that is set", lambda: robot.giraff("odom", "set", "1,2,0.5rad") == 0, PATIENCE)
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
    assert printed.read_text().splitlines()[10] == "1.00 m, 2.00 m, 0.50 rad"
