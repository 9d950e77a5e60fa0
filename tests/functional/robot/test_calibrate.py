"""`giraff calibrate odometry` beside a running robot: somebody in a terminal, and the wheels of another process."""

import math
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from giraff_sim.board import ROOT
from tests.support.process_robot import FULL_TILT, PATIENCE, ProcessRobot, process_robot
from tests.support.terminals import Screen, screen
from tests.support.waiting import wait

HALL = """
name = "hall"
start = { x = 0.0, y = 0.0, yaw_deg = 0.0 }

[[walls]]
name = "room"
points = [[4.0, 1.5], [-1.0, 1.5], [-1.0, -1.5], [4.0, -1.5]]
closed = true
"""
"""Its walls are near enough to be heard: in an empty room the guard only lets the robot creep."""
RUNS = 8


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ProcessRobot]:
    with process_robot(tmp_path_factory.mktemp("robot"), HALL, boards="host") as made:
        yield made


@pytest.fixture
def filed(tmp_path: Path) -> Path:
    """A robot file of this test's own."""
    return Path(shutil.copy(ROOT / "deploy" / "robot.toml", tmp_path / "robot.toml"))


@pytest.fixture
def shown(robot: ProcessRobot, filed: Path) -> Iterator[Screen]:
    command = [sys.executable, "-m", "giraff_cli", "calibrate", "odometry", "--file", str(filed)]
    environment = robot.environment | {"GIRAFF_ROBOT_TRACK_WIDTH": "0.48"}
    with screen(command, filed.with_name("calibrate.log"), environment) as made:
        made.wait_for("track_width is 0.48 in the robot file of this machine and 0.47 in the robot", PATIENCE)
        made.wait_for("Run 1 of", PATIENCE)
        yield made


def test_a_robot_whose_wheels_are_not_heard_is_not_begun_with(robot: ProcessRobot, filed: Path) -> None:
    command = [sys.executable, "-m", "giraff_cli", "calibrate", "odometry", "--robot", "nobody", "--file", str(filed)]
    environment = robot.environment
    ended = subprocess.run(command, check=False, capture_output=True, text=True, env=environment, timeout=PATIENCE)
    assert (ended.returncode, ended.stdout) == (2, "")
    assert "no wheels of nobody are heard" in ended.stderr
    assert f"on the network: --robot {robot.environment['GIRAFF_ROBOT_NAME']}" in ended.stderr
    assert ended.stderr.count("\n") == 1


def begin(shown: Screen) -> None:
    """As soon as the robot is heard and stands."""
    while "Drive about" not in shown.text:
        shown.forget()
        shown.type(b"\n")
        wait(lambda: any(answer in shown.read() for answer in ("Drive about", "Not yet")), PATIENCE)


def drive_to(robot: ProcessRobot, x: float) -> None:
    """Ahead; again where a machine that stood still has stopped it."""
    while robot.simulator.state().x < x:
        robot.drive(FULL_TILT, 0.0, 0.2)
        while robot.drives() and robot.simulator.state().x < x:
            robot.run(0.1)


def test_a_line_is_driven_by_another_hand_and_measured(robot: ProcessRobot, shown: Screen, filed: Path) -> None:
    before, start = filed.read_text(encoding="utf-8"), robot.simulator.state()
    begin(shown)
    drive_to(robot, start.x + 3.1)
    shown.wait_for("3.1 m, turned", PATIENCE)
    robot.hold(0.0, 0.0)
    robot.wait("standing", lambda: not robot.drives(), PATIENCE)
    robot.run(1.0)
    end = robot.simulator.state()
    shown.type(b"\n")
    shown.wait_for("metres ahead", PATIENCE)
    shown.type(f"{1000.0 * math.hypot(end.x - start.x, end.y - start.y):.0f}\n".encode())
    shown.type(f"0\n{math.degrees(end.yaw - start.yaw):.1f}deg\n".encode())
    shown.wait_for("are these millimetres?", PATIENCE)
    shown.type(f"{end.x - start.x:.3f}\n{end.y - start.y:.3f}\n{math.degrees(end.yaw - start.yaw):.1f}deg\n".encode())
    shown.wait_for("Kept:", PATIENCE)
    shown.type(b"skip\n" * (RUNS - 1))
    shown.wait_for("not determined", PATIENCE)
    shown.type(b"\n")
    assert shown.ended(PATIENCE) == 1
    assert filed.read_text(encoding="utf-8") == before


def test_ctrl_c_ends_it(shown: Screen, filed: Path) -> None:
    before = filed.read_text(encoding="utf-8")
    shown.type(b"\x03")
    assert shown.ended(PATIENCE) == 128 + signal.SIGINT
    assert filed.read_text(encoding="utf-8") == before
