"""`giraff why` from any machine, of the real robot. Each cause that it tells: tests/unit/cli/test_diagnosis.py."""

from typing import get_args

import msgspec

from giraff_cli.why.chain import LinkStatus
from tests.support.elsewhere import giraff
from tests.support.process_robot import FULL_TILT, PATIENCE, ProcessRobot


def wait_for(robot: ProcessRobot, code: int, words: str) -> list[str]:
    """The rows of the answer that says so: what follows from a change takes its time."""
    said: list[tuple[int, list[str]]] = []

    def is_said() -> bool:
        told = giraff(robot, "why")
        said.append((told.returncode, (told.stdout + told.stderr).splitlines()))
        return told.returncode == code and not told.stderr and words in conclusion(said[-1][1])

    try:
        robot.wait(words, is_said, PATIENCE)
    except AssertionError:
        raise AssertionError(f"{words}: not in {said[-1]}") from None
    return said[-1][1]


def conclusion(told: list[str]) -> str:
    return told[-1].removeprefix("sim-test: ")


def test_an_obstacle_is_named_that_stops_the_robot(robot: ProcessRobot) -> None:
    wait_for(robot, 0, "nothing stops the robot")
    robot.put_up_wall("wall", ahead=0.6, half_width=2.0)
    robot.hold(FULL_TILT, 0.0)
    told = wait_for(robot, 1, "guard: forward blocked: front_")
    # A long reason goes on in the next line.
    rows = [words for row in told[:-1] if (words := row.split())[1:2] and words[1] in get_args(LinkStatus)]
    assert [row[0] for row in rows] == [
        "hand",
        "operator",
        "lease",
        "ranger",
        "guard",
        "base",
        "e-stop",
        "board",
        "wheels",
    ]
    assert rows[4][1] == "STOPS"
    said = msgspec.json.decode(giraff(robot, "why", "--json").stdout)["conclusion"]
    assert said.startswith("guard: forward blocked: front_")
    robot.hold(0.0, 0.0)
    robot.simulator.remove_wall("wall")


def test_a_process_that_is_missing_is_named(robot: ProcessRobot) -> None:
    robot.kill("guard")
    assert "start " in conclusion(wait_for(robot, 1, "guard: "))
    robot.start("guard")
