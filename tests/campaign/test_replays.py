"""A recorded command stream said again, late: not one stale command reaches the board."""

from __future__ import annotations

from pathlib import Path

from tests.campaign.records import PROCESSES, ROBOT, judged, write_record
from tests.support.process_robot import process_robot
from tests.support.replays import record_drive, say_again
from tests.timing.faults import ARENA

LATE = (1.0, 8.0, 20.0, 60.0)
"""s."""


def test_a_recorded_drive_moves_nothing_however_late_it_is(tmp_path: Path) -> None:
    rows = []
    for late in LATE:
        directory = tmp_path / f"{late:g}"
        directory.mkdir()
        with process_robot(directory, ARENA) as robot:
            said = record_drive(robot, 0.5)
            robot.kill("joystick")  # nobody but the recording speaks for the hand
            robot.run(0.5)
            since_us = robot.simulator.now()
            say_again(robot, said, late)
            robot.run(0.5)
            verdict = robot.simulator.record(since_us)
            rows.append({"late_s": late, "samples": len(said), "driven_ms": verdict.driven_ms})
            robot.start("joystick")
            robot.drive_forward()
    print(write_record("replays", {"rows": rows}, judged(__name__, *PROCESSES, also=ROBOT)).read_text())
    assert [row["driven_ms"] for row in rows] == [0] * len(LATE)
