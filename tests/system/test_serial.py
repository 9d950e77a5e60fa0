"""Serial lines that break: unplugged, replugged, absent, and full of noise."""

from __future__ import annotations

import os
import random
import statistics
import tty
from pathlib import Path

import pytest

from giraff_cli.children import Children
from giraff_schemas.framing import encode
from giraff_schemas.wire import HelloFrame
from giraff_sim.messages import BoardName
from tests.system.robot import ProcessRobot, process_robot
from tests.system.stalls import without_stall

BOARDS: tuple[BoardName, ...] = ("base", "joystick", "ranger")
REPLUGS = 5
BOUNDS = {"base": 0.35, "joystick": 0.45, "ranger": 0.45}
"""s from unplugging a board to PWM zero."""


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
        times = [without_stall(lambda: replug_time(robot)) for _ in range(REPLUGS)]
        print(f"replug to first accepted frame: {', '.join(f'{each:.2f}' for each in sorted(times))} s")
        assert statistics.median(times) <= 1.0
        assert max(times) <= 2.0


@pytest.mark.parametrize("board", BOARDS)
def test_an_unplugged_board_stops_the_robot_and_is_named(board: BoardName, tmp_path: Path) -> None:
    with process_robot(tmp_path) as robot:

        def unplug_and_plug() -> float:
            robot.drive_forward()
            unplugged_us = robot.simulator.unplug(board)
            robot.run(1.5)
            last_us = robot.simulator.record(unplugged_us).last_driven_us
            assert last_us is not None
            path = str(robot.ports / board)
            assert any(path in message for message in robot.messages(board))
            plugged_us = robot.simulator.plug(board)
            robot.run(2.5)
            assert robot.simulator.record(plugged_us).driven_ms == 0, "the robot moved before a neutral hand"
            return (last_us - unplugged_us) * 1e-6

        took = without_stall(unplug_and_plug)
        print(f"{board} unplugged: PWM 0 after {took:.3f} s")
        assert took <= BOUNDS[board]
        robot.drive_forward()


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


def test_a_reset_of_each_board_needs_a_neutral_hand_and_is_no_jump(tmp_path: Path) -> None:
    with process_robot(tmp_path) as robot:
        robot.drive_forward()
        reset_us = robot.simulator.reset("base")
        robot.run(2.5)
        verdict = robot.simulator.record(reset_us + 5_000)
        assert verdict.driven_ms == 0, "the robot moved before a neutral hand"
        robot.drive_forward()
