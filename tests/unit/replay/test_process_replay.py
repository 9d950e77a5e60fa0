"""A recorded drive through the policies of odometry and guard, and through such as are broken."""

from collections.abc import Callable
from functools import cache
from pathlib import Path

import msgspec
import pytest

from giraff_cli.replay.agreement import Agreement
from giraff_cli.replay.policies import RecordedSamples, replay_guard, replay_odometry
from giraff_cli.replay.runner import agreements
from giraff_core.robot import RobotConfig
from giraff_guard.config import GuardConfig
from giraff_mcap.raw_sample import RawSample
from giraff_mcap.reading import Recording
from giraff_mcap.writing import RecordingWriter
from giraff_odometry.config import OdometryConfig
from giraff_schemas.messages import Sample, Tick, Wheels
from giraff_schemas.topics import topic_of
from tests.rules.repository import ROOT
from tests.unit.cli.typed import Giraff, typed
from tests.unit.mcap.recordings import ten
from tests.unit.replay.drive import DRIVE

LEAST = 0.98


def robot_of(recording: Recording) -> RobotConfig:
    return msgspec.convert(recording.tables()["robot"], RobotConfig, strict=False)


def guard_of(recording: Recording) -> GuardConfig:
    return msgspec.convert(recording.tables()["guard"], GuardConfig, strict=False)


@pytest.fixture(scope="module")
def drive() -> Recording:
    return Recording(DRIVE)


@cache
def heard() -> list[tuple[Sample, float]]:
    """The samples of the drive, with when each was heard, s from the first."""
    recording = Recording(DRIVE)
    first_ns = next(recording.samples()).heard_ns
    # What a service told of its parameters has no topic.
    known = [recorded for recorded in recording.samples() if topic_of(recorded.key) is not None]
    return [(recorded.decode(), (recorded.heard_ns - first_ns) * 1e-9) for recorded in known]


def said_where(wanted: Callable[[Sample, float], bool] = lambda _sample, _at: True) -> RecordedSamples:
    """The samples of the drive that `wanted` takes, with when it was heard, s from the first."""
    said = RecordedSamples()
    for sample, at in heard():
        if wanted(sample, at):
            said.add(sample)
    return said


def guards(recording: Recording, said: RecordedSamples, **changes: float) -> dict[str, Agreement]:
    config = msgspec.structs.replace(guard_of(recording), **changes)
    return {agreement.key: agreement for agreement in replay_guard(said, config, robot_of(recording))}


def test_the_drive_is_worth_a_replay(drive: Recording) -> None:
    assert DRIVE.stat().st_size < 1_000_000
    assert drive.seconds > 20.0
    commands = [sample.content() for sample in drive.samples(("cmd_vel",))]
    assert max(command["linear_x"] for command in commands) > 0.4
    assert min(command["linear_x"] for command in commands) < -0.2
    assert max(abs(command["angular_z"]) for command in commands) > 0.5
    assert any("blocked" in command["reason"]["what"] for command in commands)


@cache
def replayed() -> list[Agreement]:
    """Replay the whole drive, once for all tests."""
    return agreements(Recording(DRIVE), {})


def test_odometry_says_the_same_to_the_last_bit() -> None:
    [found] = (agreement for agreement in replayed() if agreement.key == "odom")
    print(found)
    assert found.compared > 1500
    assert found.equal == found.compared
    assert found.left_out <= 5


def test_the_guard_says_the_same() -> None:
    found = {agreement.key: agreement for agreement in replayed()}
    print(found)
    assert found["cmd_vel"].compared > 900
    assert found["guard"].compared > 150
    for agreement in found.values():
        assert agreement.equal == agreement.compared, agreement


def test_a_guard_that_was_running_already_is_replayed_from_where_its_memory_is_known(drive: Recording) -> None:
    found = guards(drive, said_where(lambda _sample, at: at > 6.0))
    print(found)
    assert found["cmd_vel"].compared > 150
    assert found["cmd_vel"].left_out > 200
    for agreement in found.values():
        assert agreement.share >= LEAST, agreement


def test_a_recording_whose_first_tick_comes_late_knows_who_held_the_lease(drive: Recording) -> None:
    found = guards(drive, said_where(lambda sample, at: at > (6.1 if isinstance(sample, Tick) else 6.0)))
    assert found["lease"].compared > 50
    assert found["lease"].equal == found["lease"].compared


def test_odometry_goes_on_behind_a_gap(drive: Recording) -> None:
    said = said_where(lambda sample, at: 3.0 < at < 16.0 and not (isinstance(sample, Wheels) and 8.0 < at < 9.0))
    found = replay_odometry(said, OdometryConfig(), robot_of(drive))
    assert found.compared > 1000
    assert found.equal == found.compared


@pytest.mark.parametrize(
    "changes", [{"margin": 0.5}, {"deceleration": 0.5}, {"idle_release": 0.1}, {"reaction_time": 0.5}]
)
def test_a_guard_that_judges_otherwise_shows(drive: Recording, changes: dict[str, float]) -> None:
    said = said_where(lambda _sample, at: at < 12.0)
    assert min(agreement.share for agreement in guards(drive, said, **changes).values()) < LEAST


def test_odometry_of_other_wheels_shows(drive: Recording) -> None:
    robot = msgspec.structs.replace(robot_of(drive), track_width=0.471)
    assert replay_odometry(said_where(lambda _, at: at < 8.0), OdometryConfig(), robot).share < LEAST


@pytest.fixture
def giraff_replay(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Giraff:
    """The command: exit code, output and complaint."""
    monkeypatch.delenv("GIRAFF_CONFIG", raising=False)
    return lambda *words: typed(monkeypatch, capsys, "replay", *words)


def test_a_recording_without_a_robot_file_takes_one_from_here(
    giraff_replay: Giraff, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A desk needs none to record, and tells whoever replays that there where none is, either."""
    about = {name: value for name, value in Recording(DRIVE).about.items() if name != "tables"}
    with RecordingWriter(tmp_path / "bare.mcap", about) as writer:
        writer.add(ten())
        writer.close("test")
    monkeypatch.chdir(ROOT)
    assert "no robot file" not in giraff_replay(str(tmp_path / "bare.mcap"))[2]
    monkeypatch.chdir(tmp_path)
    code, _, complaint = giraff_replay("bare.mcap")
    assert code == 2
    assert "bare.mcap was recorded where its robot file was not; no robot file at" in complaint
    assert "GIRAFF_CONFIG" in complaint


def test_samples_that_cannot_be_decoded_are_named(giraff_replay: Giraff, tmp_path: Path) -> None:
    torn = [sample._replace(payload=msgspec.msgpack.encode({"seq": 1, "instance": "i"})) for sample in ten()]
    with RecordingWriter(tmp_path / "torn.mcap", Recording(DRIVE).about) as writer:
        writer.add(torn)
        writer.close("test")
    code, _, complaint = giraff_replay(str(tmp_path / "torn.mcap"))
    assert code == 2
    assert "torn.mcap: left out: giraff/sim-test/odom: not a Odometry: `" in complaint
    assert "nothing in it can be compared" in complaint
    assert "all that the guard hears for 21 s in which the robot goes 2 m" in complaint


def test_a_recording_that_is_too_short_tells_what_it_takes(giraff_replay: Giraff, tmp_path: Path) -> None:
    samples = list(Recording(DRIVE).samples())
    part = [each for each in samples if 6.0 < (each.heard_ns - samples[0].heard_ns) * 1e-9 < 10.0]
    with RecordingWriter(tmp_path / "short.mcap", Recording(DRIVE).about) as writer:
        writer.add([RawSample(each.heard_ns, each.topic, each.payload, each.encoding) for each in part])
        writer.close("test")
    code, _, complaint = giraff_replay(str(tmp_path / "short.mcap"))
    assert code == 2
    assert "short.mcap: cmd_vel, guard, lease: nothing could be compared in 4 s: " in complaint
    assert "record from its start, or for 21 s in which the robot goes 2 m" in complaint


def test_the_command_tells_it(giraff_replay: Giraff, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Path] = []

    def recall(recording: Recording, *_: object) -> list[Agreement]:
        asked.append(recording.path)
        return replayed()

    monkeypatch.setattr("giraff_cli.replay.runner.agreements", recall)
    code, text, complaint = giraff_replay(str(DRIVE))
    assert (code, complaint) == (0, "")
    assert "odometry" in text
    assert "100.00%" in text
    rows = msgspec.json.decode(giraff_replay(str(DRIVE), "--json")[1])
    assert [row["key"] for row in rows] == ["odom", "cmd_vel", "guard", "lease"]
    assert giraff_replay(str(DRIVE), "--least", "1")[0] == (0 if all(row["share"] == 1 for row in rows) else 1)
    assert asked == [DRIVE] * 3
    nothing = giraff_replay(str(tmp_path / "none.mcap"))
    assert nothing == (2, "", f"giraff: {tmp_path}/none.mcap: No such file or directory\n")
