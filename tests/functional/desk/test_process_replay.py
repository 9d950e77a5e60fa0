"""A recorded drive through the policies of odometry and guard, and through such as are broken."""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from pathlib import Path

import msgspec
import pytest

from giraff_cli.agreement import Agreement
from giraff_cli.process_replay import Said, replay_guard, replay_odometry
from giraff_guard.config import GuardConfig
from giraff_mcap.reading import Recording
from giraff_mcap.writing import RecordingWriter
from giraff_node.robot import RobotConfig
from giraff_odometry.config import OdometryConfig
from giraff_schemas.messages import Sample, Tick, Wheels
from tests.functional.desk.make_drive import DRIVE
from tests.support.elsewhere import GIRAFF
from tests.unit.mcap.recordings import ten

LEAST = 0.98


def robot_of(recording: Recording) -> RobotConfig:
    return msgspec.convert(recording.tables()["robot"], RobotConfig, strict=False)


def guard_of(recording: Recording) -> GuardConfig:
    return msgspec.convert(recording.tables()["guard"], GuardConfig, strict=False)


@pytest.fixture(scope="module")
def drive() -> Recording:
    return Recording(DRIVE)


def said_in(recording: Recording, wanted: Callable[[Sample, float], bool] = lambda _sample, _at: True) -> Said:
    """The samples of a recording that `wanted` takes, with when it was heard, s from the first."""
    said = Said()
    first_ns = next(recording.samples()).heard_ns
    for recorded in recording.samples():
        if wanted(sample := recorded.decode(), (recorded.heard_ns - first_ns) * 1e-9):
            said.add(sample)
    return said


def guards(recording: Recording, said: Said, **changes: float) -> dict[str, Agreement]:
    config = msgspec.structs.replace(guard_of(recording), **changes)
    return {agreement.key: agreement for agreement in replay_guard(said, config, robot_of(recording))}


def test_the_drive_is_worth_a_replay(drive: Recording) -> None:
    assert DRIVE.stat().st_size < 1_000_000
    assert drive.seconds > 20.0
    commands = [sample.content() for sample in drive.samples(("cmd_vel",))]
    assert max(command["linear_x"] for command in commands) > 0.4
    assert min(command["linear_x"] for command in commands) < -0.2
    assert max(abs(command["angular_z"]) for command in commands) > 0.5
    assert any("blocked" in command["reason"] for command in commands)


def test_odometry_says_the_same_to_the_last_bit(drive: Recording) -> None:
    found = replay_odometry(said_in(drive), OdometryConfig(), robot_of(drive))
    print(found)
    assert found.compared > 1500
    assert found.equal == found.compared
    assert found.left_out <= 5


def test_the_guard_says_the_same(drive: Recording) -> None:
    found = guards(drive, said_in(drive))
    print(found)
    assert found["cmd_vel"].compared > 900
    assert found["guard"].compared > 150
    for agreement in found.values():
        assert agreement.share >= LEAST, agreement


def test_a_guard_that_was_running_already_is_replayed_from_where_its_memory_is_known(drive: Recording) -> None:
    found = guards(drive, said_in(drive, lambda _sample, at: at > 6.0))
    print(found)
    assert found["cmd_vel"].compared > 150
    assert found["cmd_vel"].left_out > 200
    for agreement in found.values():
        assert agreement.share >= LEAST, agreement


def test_a_recording_whose_first_tick_comes_late_knows_who_held_the_lease(drive: Recording) -> None:
    found = guards(drive, said_in(drive, lambda sample, at: at > (6.1 if isinstance(sample, Tick) else 6.0)))
    assert found["lease"].compared > 50
    assert found["lease"].equal == found["lease"].compared


def test_odometry_goes_on_behind_a_gap(drive: Recording) -> None:
    said = said_in(drive, lambda sample, at: at > 3.0 and not (isinstance(sample, Wheels) and 8.0 < at < 9.0))
    found = replay_odometry(said, OdometryConfig(), robot_of(drive))
    assert found.compared > 1000
    assert found.equal == found.compared


@pytest.mark.parametrize(
    "changes", [{"margin": 0.5}, {"deceleration": 0.5}, {"idle_release": 0.1}, {"reaction_time": 0.5}]
)
def test_a_guard_that_judges_otherwise_shows(drive: Recording, changes: dict[str, float]) -> None:
    assert min(agreement.share for agreement in guards(drive, said_in(drive), **changes).values()) < LEAST


def test_odometry_of_other_wheels_shows(drive: Recording) -> None:
    robot = msgspec.structs.replace(robot_of(drive), track_width=0.471)
    assert replay_odometry(said_in(drive), OdometryConfig(), robot).share < LEAST


def giraff_replay(*words: str, at: Path | None = None) -> subprocess.CompletedProcess[str]:
    """`at`: the working directory."""
    command = [str(GIRAFF), "replay", *words]
    return subprocess.run(command, check=False, capture_output=True, text=True, timeout=60.0, cwd=at)


def test_a_recording_without_a_robot_file_takes_one_from_here(tmp_path: Path) -> None:
    """A desk needs none to record, and tells whoever replays that there where none is, either."""
    about = {name: value for name, value in Recording(DRIVE).about.items() if name != "tables"}
    with RecordingWriter(tmp_path / "bare.mcap", about) as writer:
        writer.add(ten())
        writer.close("test")
    told = giraff_replay("bare.mcap", at=tmp_path)
    assert told.returncode == 2
    assert "bare.mcap was recorded where its robot file was not; no robot file at" in told.stderr
    assert "GIRAFF_CONFIG" in told.stderr
    assert "no robot file" not in giraff_replay(str(tmp_path / "bare.mcap")).stderr


def test_a_recording_of_another_version_is_named(tmp_path: Path) -> None:
    old = [sample._replace(payload=msgspec.msgpack.encode({"seq": 1, "instance": "i"})) for sample in ten()]
    with RecordingWriter(tmp_path / "old.mcap", Recording(DRIVE).about) as writer:
        writer.add(old)
        writer.close("test")
    told = giraff_replay(str(tmp_path / "old.mcap"))
    assert told.returncode == 2
    assert "old.mcap: not of this version: giraff/sim-test/odom: not a Odometry: Object missing" in told.stderr
    assert "nothing in it can be compared" in told.stderr


def test_the_command_tells_it(tmp_path: Path) -> None:
    told = giraff_replay(str(DRIVE))
    assert (told.returncode, told.stderr) == (0, "")
    assert "odometry" in told.stdout
    assert "100.00%" in told.stdout
    rows = msgspec.json.decode(giraff_replay(str(DRIVE), "--json").stdout)
    assert [row["key"] for row in rows] == ["odom", "cmd_vel", "guard", "lease"]
    assert giraff_replay(str(DRIVE), "--least", "1").returncode == (0 if all(row["share"] == 1 for row in rows) else 1)
    nothing = giraff_replay(str(tmp_path / "none.mcap"))
    assert nothing.returncode == 2
    assert nothing.stderr == f"giraff: {tmp_path}/none.mcap: No such file or directory\n"
