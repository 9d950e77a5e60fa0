"""`giraff why` from any machine: the real robot, and what stops it one after another."""

from __future__ import annotations

import signal
from collections.abc import Iterator

import msgspec
import pytest

from tests.support.elsewhere import giraff
from tests.support.process_robot import FULL_TILT, PATIENCE, ProcessRobot, process_robot


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ProcessRobot]:
    with process_robot(tmp_path_factory.mktemp("robot"), boards="host") as made:
        yield made


def wait_for(robot: ProcessRobot, code: int, words: str) -> list[str]:
    """The rows of the answer that says so: what follows from a change takes its time."""
    said: list[tuple[int, list[str]]] = []

    def is_said() -> bool:
        told = giraff(robot, "why")
        assert told.stderr == ""
        said.append((told.returncode, told.stdout.splitlines()))
        return told.returncode == code and words in conclusion(said[-1][1])

    try:
        robot.wait(words, is_said, PATIENCE)
    except AssertionError:
        raise AssertionError(f"{words}: not in {said[-1]}") from None
    return said[-1][1]


def conclusion(told: list[str]) -> str:
    return told[-1].removeprefix("sim-test: ")


def test_what_stops_the_robot_is_named(robot: ProcessRobot) -> None:
    robot.arm()
    wait_for(robot, 0, "nothing stops the robot")
    robot.put_up_wall("wall", ahead=0.6, half_width=2.0)
    robot.hold(FULL_TILT, 0.0)
    told = wait_for(robot, 1, "guard: forward blocked by range_front_")
    rows = [row.split() for row in told]
    names = [row[0] for row in rows[:-1]]
    assert names == ["hand", "operator", "lease", "ranger", "guard", "base", "e-stop", "board", "wheels"]
    assert rows[4][1] == "STOPS"
    robot.hold(0.0, 0.0)  # guard doubts the way ahead for a while: the wall is gone, and all is silent there
    robot.simulator.remove_wall("wall")
    assert giraff(robot, "estop", "engage", "--timeout", "60", "--reason", "a cat").returncode == 0
    told = wait_for(robot, 1, ": a cat")
    assert conclusion(told).startswith("e-stop: engaged by ")
    said = msgspec.json.decode(giraff(robot, "why", "--json").stdout)["conclusion"]
    assert said.startswith("e-stop: engaged by ")
    assert giraff(robot, "estop", "reset", "--timeout", "60").returncode == 0
    robot.arm()


def test_a_process_that_is_missing_or_hangs_is_named(robot: ProcessRobot) -> None:
    robot.kill("guard")
    assert "start " in conclusion(wait_for(robot, 1, "guard: "))
    robot.start("guard")
    robot.arm()
    robot.signal("guard", signal.SIGSTOP)
    try:
        wait_for(robot, 1, "guard: giraff_guard is not running, or hangs; start it on base's machine")
    finally:
        robot.signal("guard", signal.SIGCONT)
    robot.simulator.unplug("base")
    wait_for(robot, 1, f"board: {robot.ports / 'base'}: ")
    robot.simulator.plug("base")
    robot.simulator.unplug("joystick")
    wait_for(robot, 1, f"hand: no frame from the joystick board on {robot.ports / 'joystick'}")
    robot.simulator.plug("joystick")
    robot.arm()


def test_without_a_robot_it_says_so(robot: ProcessRobot) -> None:
    told = giraff(robot, "why", name="otto")
    assert told.returncode == 2
    assert "no robot called otto is heard on the network; check that it is on" in told.stderr
    assert told.stderr.rstrip().endswith("on the network: --robot sim-test")
