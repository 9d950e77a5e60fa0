"""What a recorder costs, how much of a minute is in its file, and how much a kill takes of it."""

import time
from collections.abc import Iterator

import msgspec
import psutil
import pytest
from mcap.reader import make_reader

from giraff_mcap.reading import Recording
from giraff_schemas.topics import TOPICS
from tests.support.process_robot import FULL_TILT, ProcessRobot, process_robot
from tests.support.recorders import giraff_process, killed_recording, records, share_of_a_core
from tests.timing.stalled import by_the_wall

MINUTE = 60.0


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ProcessRobot]:
    with process_robot(tmp_path_factory.mktemp("robot"), boards="host") as running:
        running.drive(FULL_TILT / 3.0, FULL_TILT, 0.5)  # in circles from now on
        yield running


def test_a_minute_of_a_drive_costs_little_and_is_in_the_file(robot: ProcessRobot) -> None:
    path = robot.directory / "minute.mcap"
    with giraff_process(robot, "record", "-o", path.name, "--for", f"{MINUTE:g}", "--json") as process:
        records(process, path)
        share = share_of_a_core(psutil.Process(process.pid), MINUTE - 10.0)
        output, _ = process.communicate(timeout=30.0)
    assert process.returncode == 0
    report = msgspec.json.decode(output)
    assert (report["lost"], report["ended_by"], report["unreadable"]) == (0, "--for 60", {})
    with path.open("rb") as file:
        summary = make_reader(file, validate_crcs=True).get_summary()
    assert summary is not None
    rates = {topic.key: topic.rate_hz for topic in TOPICS}
    print(f"{share:.1%} of a core")
    assert len(summary.chunk_indexes) > MINUTE
    for key in ("wheels", "odom", "cmd_vel", "tick"):
        assert report["keys"][key]["samples"] > MINUTE * rates[key] / 2.0, key
    assert share < 0.10


def test_a_kill_costs_less_than_a_second(robot: ProcessRobot) -> None:
    begin_ns = time.monotonic_ns()
    path, at_ns = killed_recording(robot, "killed.mcap")
    with by_the_wall(begin_ns):
        assert at_ns - max(sample.heard_ns for sample in Recording(path).samples()) < 1_000_000_000
