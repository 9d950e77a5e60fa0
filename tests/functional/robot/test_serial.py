"""Serial lines that break: replugged, absent, and full of noise. What an unplugged board stops is a row of faults."""

from __future__ import annotations

import os
import random
import statistics
import time
import tty
from pathlib import Path

import pytest

from giraff_cli.children import Children
from giraff_schemas.framing import encode
from giraff_schemas.wire import HelloFrame
from giraff_sim.messages import BoardName
from tests.support.process_robot import ProcessRobot, process_robot
from tests.timing.stalled import by_the_wall

BOARDS: tuple[BoardName, ...] = ("base", "joystick", "ranger")
REPLUGS = 5


def replug_time(robot: ProcessRobot) -> float:
    """Unplug the base board, plug it in: simulated s until it has accepted a drive frame."""
    robot.simulator.unplug("base")
    robot.run(0.5)
    plugged_us = robot.simulator.plug("base")
    accepted = robot.accepted()
    robot.wait("an accepted frame after the replug", lambda: robot.accepted() != accepted, 10.0)
    first_us = robot.simulator.record(plugged_us).first_accepted_us
    assert first_us is not None
    return (first_us - plugged_us) * 1e-6


def test_a_replugged_base_board_is_back_in_time(tmp_path: Path) -> None:
    with process_robot(tmp_path) as robot:
        begin_ns = time.monotonic_ns()
        times = [replug_time(robot) for _ in range(REPLUGS)]
        print(f"replug to first accepted frame: {', '.join(f'{each:.2f}' for each in sorted(times))} s")
        with by_the_wall(begin_ns):
            assert statistics.median(times) <= 1.0
            assert max(times) <= 2.0


@pytest.mark.parametrize("board", BOARDS)
def test_noise_and_torn_frames_are_survived_and_named(board: BoardName, tmp_path: Path) -> None:
    with process_robot(tmp_path) as robot:
        master, slave = os.openpty()
        tty.setraw(slave)
        children = Children(tmp_path / "noise")
        (tmp_path / "noise").mkdir()
        port = {f"GIRAFF_{board.upper()}_PORT": os.ttyname(slave), "GIRAFF_ROBOT_NAME": "sim-noise"}
        children.start("service", f"giraff_{board}", (), robot.environment | port)
        robot.wait("its start", lambda: "sim-noise" in children.log("service").read_text(), 10.0)
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
        assert children.stop_all(grace=3.0) == []
        os.close(master)
        os.close(slave)


def test_an_absent_port_is_named_and_tried_again(tmp_path: Path) -> None:
    with process_robot(tmp_path) as robot:
        robot.simulator.unplug("base")
        robot.kill("base")
        robot.start("base")
        path = robot.ports / "base"
        robot.wait("the path's name", lambda: f"{path}: no such port" in robot.log("base"), 5.0)
        robot.simulator.plug("base")
        accepted = robot.accepted()
        robot.wait("an accepted frame", lambda: robot.accepted() != accepted, 5.0)
