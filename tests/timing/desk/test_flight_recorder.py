"""How much of the moments before and after an emergency stop the flight recorder keeps."""

import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from giraff_mcap.reading import Recording
from giraff_schemas.messages import EStop
from tests.support.process_robot import ProcessRobot, process_robot
from tests.timing.stalled import by_the_wall


@pytest.fixture
def robot(tmp_path: Path) -> Iterator[ProcessRobot]:
    with process_robot(tmp_path, boards="host") as running:
        running.environment |= {
            "GIRAFF_RECORDER_BEFORE": "4",
            "GIRAFF_RECORDER_AFTER": "1",
            "GIRAFF_RECORDER_FILES": "2",
        }
        yield running


def files(robot: ProcessRobot) -> list[Path]:
    return sorted((robot.state / "incidents").glob("*.mcap"))


def whole(robot: ProcessRobot, count: int) -> bool:
    return len(files(robot)) >= count and all(b"\x89MCAP" in path.read_bytes()[-8:] for path in files(robot))


def test_as_much_is_kept_as_was_asked_for(robot: ProcessRobot) -> None:
    begin_ns = time.monotonic_ns()
    robot.start("recorder")
    robot.drive_forward()
    robot.run(5.0)
    assert robot.giraff("estop", "engage", "--reason", "a cat") == 0
    robot.wait("the file of the stop", lambda: whole(robot, 1), 15.0)
    (path,) = files(robot)
    recording = Recording(path)
    stops = [
        sample
        for sample in recording.samples(("estop",))
        if isinstance(said := sample.decode(), EStop) and said.engaged
    ]
    ends = max(sample.heard_ns for sample in recording.samples())
    with by_the_wall(begin_ns):
        assert 4.0 < recording.seconds < 6.5
        assert 0.5 < (ends - stops[0].heard_ns) * 1e-9 < 3.0
