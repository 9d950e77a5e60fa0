"""Serial lines that break: replugged, absent, and full of noise. What an unplugged board stops is a row of faults."""

import os
import random
import tty
from collections.abc import Iterator
from pathlib import Path

import pytest

from giraff_cli.run.processes import ProcessGroup
from giraff_schemas.framing import encode
from giraff_schemas.wire import HelloFrame
from giraff_sim.control.messages import BoardName
from tests.support.process_robot import BRIEF, PATIENCE, ProcessRobot, process_robot

BOARDS: tuple[BoardName, ...] = ("base", "joystick", "ranger")


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ProcessRobot]:
    with process_robot(tmp_path_factory.mktemp("robot"), boards="host") as made:
        yield made


def test_a_replugged_base_board_is_back(robot: ProcessRobot) -> None:
    robot.simulator.unplug("base")
    robot.run(0.5)
    robot.simulator.plug("base")
    accepted = robot.accepted()
    robot.wait("an accepted frame after the replug", lambda: robot.accepted() != accepted, PATIENCE)
    robot.drive_forward(BRIEF)
    robot.hold(0.0, 0.0)


@pytest.mark.parametrize("board", BOARDS)
def test_noise_and_torn_frames_are_survived_and_named(board: BoardName, robot: ProcessRobot, tmp_path: Path) -> None:
    master, slave = os.openpty()
    tty.setraw(slave)
    children = ProcessGroup(tmp_path / "noise")
    (tmp_path / "noise").mkdir()
    port = {f"GIRAFF_{board.upper()}_PORT": os.ttyname(slave), "GIRAFF_ROBOT_NAME": "sim-noise"}
    children.start("service", "giraff_node", (board,), robot.environment | port)
    robot.wait("its start", lambda: "sim-noise" in children.log("service").read_text(), PATIENCE)
    noise = random.Random(1)
    hello = encode(HelloFrame(0, 0, 9, 0, 1, 1).pack())
    os.set_blocking(master, False)
    for _ in range(400):
        torn = hello[: noise.randrange(len(hello))]
        try:
            os.write(master, noise.randbytes(100) + torn)
        except BlockingIOError:
            robot.run(0.02)
    robot.run(0.5)
    assert not children.reap(), children.log("service").read_text()
    assert os.ttyname(slave) in children.log("service").read_text()
    assert children.stop_all(grace=PATIENCE) == []
    os.close(master)
    os.close(slave)


def test_an_absent_port_is_named_and_tried_again(robot: ProcessRobot) -> None:
    robot.simulator.unplug("base")
    robot.kill("base")
    robot.start("base")
    path = robot.ports / "base"
    robot.wait("the path's name", lambda: f"{path}: no such port" in robot.log("base"), PATIENCE)
    robot.simulator.plug("base")
    accepted = robot.accepted()
    robot.wait("an accepted frame", lambda: robot.accepted() != accepted, PATIENCE)
