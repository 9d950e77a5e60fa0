"""`giraff why` from any machine: the real robot, and what stops it one after another."""

from __future__ import annotations

import signal
from pathlib import Path

import msgspec

from giraff_cli.watcher import free_port
from tests.support.elsewhere import giraff
from tests.support.process_robot import FULL_TILT, ProcessRobot, process_robot


def wait_for(robot: ProcessRobot, code: int, words: str) -> list[str]:
    """The rows of the answer that says so: what follows from a change takes its time."""
    said: list[tuple[int, list[str]]] = []

    def is_said() -> bool:
        told = giraff(robot, "why")
        assert told.stderr == ""
        said.append((told.returncode, told.stdout.splitlines()))
        return told.returncode == code and words in conclusion(said[-1][1])

    try:
        robot.wait(words, is_said, 15.0)
    except AssertionError:
        raise AssertionError(f"{words}: not in {said[-1]}") from None
    return said[-1][1]


def conclusion(told: list[str]) -> str:
    return told[-1].removeprefix("sim-test: ")


def test_what_stops_the_robot_is_named(tmp_path: Path) -> None:
    with process_robot(tmp_path, boards="host") as robot:
        robot.arm()
        wait_for(robot, 0, "nothing stops the robot")
        robot.drive_forward()
        wait_for(robot, 0, "the robot drives")
        robot.put_up_wall("wall", ahead=1.2, half_width=2.0)
        told = wait_for(robot, 1, "guard: forward blocked by range_front_")
        rows = [row.split() for row in told]
        names = [row[0] for row in rows[:-1]]
        assert names == ["hand", "operator", "lease", "ranger", "guard", "base", "e-stop", "board", "wheels"]
        assert rows[4][1] == "STOPS"
        robot.simulator.remove_wall("wall")
        assert giraff(robot, "estop", "engage", "--reason", "a cat").returncode == 0
        told = wait_for(robot, 1, ": a cat")
        assert conclusion(told).startswith("e-stop: engaged by ")
        assert msgspec.json.decode(giraff(robot, "why", "--json").stdout)["conclusion"] == conclusion(told)
        robot.hold(-FULL_TILT, 0.0)  # guard doubts the way ahead for a while: the wall is gone, and all is silent there
        assert giraff(robot, "estop", "reset").returncode == 0
        wait_for(robot, 1, "base: not armed")


def test_a_process_that_is_missing_or_hangs_is_named(tmp_path: Path) -> None:
    with process_robot(tmp_path, boards="host") as robot:
        robot.arm()
        for service, link in {"ranger": "ranger", "guard": "guard", "joystick": "operator", "base": "base"}.items():
            robot.kill(service)
            told = conclusion(wait_for(robot, 1, f"{link}: "))
            assert told.startswith(f"{link}: "), told
            assert "start " in told
            robot.start(service)
            robot.arm(20.0)
        robot.signal("guard", signal.SIGSTOP)
        wait_for(robot, 1, "guard: giraff_guard is not running, or hangs; start it on base's machine")
        robot.signal("guard", signal.SIGCONT)
        robot.simulator.unplug("base")
        wait_for(robot, 1, f"board: {robot.ports / 'base'}: ")
        robot.simulator.plug("base")
        robot.simulator.unplug("joystick")
        wait_for(robot, 1, f"hand: no frame from the joystick board on {robot.ports / 'joystick'}")
        robot.simulator.plug("joystick")
        robot.hold(FULL_TILT, 0.0)
        wait_for(robot, 1, "base: not armed")


def test_without_a_robot_it_says_so(tmp_path: Path) -> None:
    with process_robot(tmp_path, boards="host") as robot:
        told = giraff(robot, "why", name="otto")
        assert told.returncode == 2
        assert "no robot called otto is heard on the network; check that it is on" in told.stderr
        assert told.stderr.rstrip().endswith("on the network: --robot sim-test")
        robot.environment["GIRAFF_NETWORK_RENDEZVOUS"] = f"127.0.0.1:{free_port()}"
        told = giraff(robot, "why", "--for", "1", name="sim-test")
        assert (told.returncode, told.stdout) == (2, "")
