"""The flight recorder beside a robot: an emergency stop leaves a file of the moments before and after."""

from collections.abc import Iterator

import pytest

from giraff_mcap.reading import Recording
from giraff_schemas.messages import EStop
from tests.support.process_robot import BRIEF, SAID, ProcessRobot

STOPPED = "emergency stop by "


@pytest.fixture(scope="module", autouse=True)
def _recorder(robot: ProcessRobot) -> Iterator[None]:
    """The recorder ends with these tests."""
    settings = {"BEFORE": "4", "AFTER": "1", "FILES": "9"}
    robot.environment |= {f"GIRAFF_RECORDER_{name}": value for name, value in settings.items()}
    robot.start("recorder")
    yield
    robot.stop("recorder")


def kept(robot: ProcessRobot, incident: str) -> list[Recording]:
    """What is kept, and whole, of such incidents: a machine that stands still adds others."""
    paths = sorted((robot.state / "incidents").glob("*.mcap"))
    whole = [Recording(path) for path in paths if b"\x89MCAP" in path.read_bytes()[-8:]]
    return [recording for recording in whole if recording.about["incident"].startswith(incident)]


def test_a_stop_and_a_death_are_kept_with_what_came_before(robot: ProcessRobot) -> None:
    robot.drive_forward(BRIEF)
    robot.run(2.0)
    assert kept(robot, STOPPED) == []
    assert robot.giraff("estop", "engage", "--reason", "a cat") == 0
    robot.wait("the file of the stop", lambda: kept(robot, STOPPED), 60.0)
    recording = kept(robot, STOPPED)[0]
    assert recording.path.name.endswith("-estop.mcap")
    assert ": a cat" in recording.about["incident"]
    stops = [
        sample
        for sample in recording.samples(("estop",))
        if isinstance(said := sample.decode(), EStop) and said.engaged
    ]
    heard = [sample.heard_ns for sample in recording.samples()]
    assert (stops[0].heard_ns - min(heard)) * 1e-9 > 1.0
    assert max(heard) > stops[0].heard_ns
    assert set(recording.keys) >= SAID
    robot.release()
    robot.kill("guard")
    robot.wait("the file of the death", lambda: kept(robot, "guard ended while the robot was armed"), 60.0)
    robot.start("guard")


def test_a_folder_that_cannot_be_written_is_a_fault_that_health_tells(robot: ProcessRobot) -> None:
    robot.stop("recorder")
    (robot.state / "incidents").mkdir(exist_ok=True)  # the recorder makes it with its first file
    (robot.state / "incidents").rename(robot.state / "kept")
    (robot.state / "incidents").write_text("in the way")
    robot.start("recorder")

    def is_told() -> bool:
        """A recorder that has just started may miss a stop, but not one after another."""
        assert robot.giraff("estop", "engage") == 0
        assert robot.giraff("estop", "reset") == 0
        return any("File exists; make room" in line for line in robot.messages("recorder"))

    robot.wait("the fault", is_told, 60.0)
