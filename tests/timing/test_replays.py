"""A recorded command stream said again, late: not one stale command reaches the board."""

from pathlib import Path

import pytest

from tests.support.process_robot import ARENA, process_robot
from tests.support.replays import record_drive, say_again
from tests.support.report import report

LATE = (1.0, 8.0, 20.0, 60.0)
"""s."""


@pytest.mark.timeout(600)
def test_a_recorded_drive_moves_nothing_however_late_it_is(tmp_path: Path) -> None:
    rows = []
    for late in LATE:
        directory = tmp_path / f"{late:g}"
        directory.mkdir()
        with process_robot(directory, ARENA) as robot:
            said = record_drive(robot, 1.7)
            robot.kill("joystick")  # nobody but the recording speaks for the hand
            robot.run(0.5)
            since_us = robot.simulator.now()
            say_again(robot, said, late)
            robot.run(0.5)
            verdict = robot.simulator.record(since_us)
            rows.append({"late_s": late, "samples": len(said), "driven_ms": verdict.driven_ms})
            robot.start("joystick")
            robot.drive_forward()
    report("timing/replays", {"rows": rows})
    assert [row["driven_ms"] for row in rows] == [0] * len(LATE)
