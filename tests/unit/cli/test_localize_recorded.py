"""`giraff localize --from`: a recorded drive through a localization that says what a test wants it to."""

import json
import tomllib
from pathlib import Path
from typing import Any

import pytest

from giraff_cli.localize import offline
from giraff_cli.localize.offline import RecordedDrive, TrueWay, summarize, to_text
from giraff_core.kinematics.pose import Pose
from giraff_maps.floor_plan import FloorPlan
from giraff_mcap.raw_sample import RawSample
from giraff_mcap.writing import RecordingWriter
from giraff_schemas.codec import encode, encoding_of, stamped
from giraff_schemas.localization import LocalizationAnswer, LocalizationSetPose, LocalizationState, MapPose
from giraff_schemas.messages import Odometry, Range, Sample, TruePose
from giraff_schemas.scan import RAYS, LaserScan
from giraff_schemas.topics import BASE, ODOM, RANGE, SCAN, TRUE_POSE, Topic, key_of
from giraff_schemas.trouble import Trouble
from giraff_sim.world.room import Pose as Start
from giraff_sim.world.room import Room, read_room
from tests.rules.repository import ROOT
from tests.unit.cli.map_poses import map_pose
from tests.unit.cli.samples import MS, at, base, odometry, reading
from tests.unit.cli.typed import Giraff
from tests.unit.mcap.recordings import ABOUT

ROOM = ROOT / "deploy" / "worlds" / "living_room.toml"
SPEED = 0.5e-3  # m/ms
FOUND_AT = 1.0  # m of way


class Follower:
    """A localization that is lost for a metre, and then 3 cm beside where odometry has it."""

    def __init__(self, *_: Any) -> None:
        self.heard: list[str] = []
        self.told: LocalizationSetPose | None = None
        self.refuses = ""
        self._newest: Odometry | None = None
        self._left = 0

    def on_odometry(self, sample: Odometry) -> None:
        self._newest, self._left = sample, 3
        self.heard.append("odom")

    def on_sample(self, sample: Range | LaserScan) -> None:
        self._left = 3
        self.heard.append(sample.sensor)

    def on_set_pose(self, request: LocalizationSetPose) -> LocalizationAnswer:
        self.told = request
        return LocalizationAnswer(done=not self.refuses, reason=Trouble(self.refuses))

    def work(self) -> bool:
        self._left = max(0, self._left - 1)
        return self._left > 0

    def pose(self) -> MapPose:
        assert self._left == 0, "it has not computed all that it had to"
        newest = self._newest
        assert newest is not None
        place = Pose(newest.x, newest.y, newest.yaw).placed_in(Pose(1.5, 2.2, 0.0))
        state: LocalizationState = "localized" if newest.path >= FOUND_AT or self.told else "lost"
        return map_pose(newest.tick.robot_ns, place._replace(y=place.y + 0.03), state)


def drive(seconds: float = 4.0) -> list[tuple[Topic[Any], str, Sample, int]]:
    """Straight on at 0.5 m/s: topic, name below it, sample, ms."""
    found: list[tuple[Topic[Any], str, Sample, int]] = []
    for ms in range(0, round(seconds * 1000) + 1, 10):
        x = SPEED * ms
        found.append((ODOM, "", stamped(odometry(ms * MS, x), ms, ms * MS, "one"), ms))
        if ms % 200 == 0:
            found.append((RANGE, "rear", stamped(reading("rear", 1.0, "echo"), ms, ms * MS, "two"), ms))
            true = TruePose(x=x, y=0.0, yaw=0.0, tick=at(ms * MS))
            found.append((TRUE_POSE, "", stamped(true, ms, ms * MS, "three"), ms))
    return found


def through(policy: Follower, room: Room | None, place: Pose | None = None, samples: Any = None) -> RecordedDrive:
    driven = RecordedDrive(policy, place, room)  # type: ignore[arg-type]  # it has what is asked
    for _, _, sample, ms in samples or drive():
        driven.on_sample(sample, ms * MS)
    return driven


def test_what_was_heard_goes_in_in_its_order_and_the_way_is_shared() -> None:
    policy = Follower()
    driven = through(policy, read_room(ROOM))
    assert policy.heard[:4] == ["odom", "rear", "odom", "odom"]
    assert driven.way == pytest.approx(2.0)
    assert driven.seconds == pytest.approx(4.0)
    shares = driven.shares.shares
    assert shares is not None
    assert shares["lost"] == pytest.approx(0.5, abs=0.03)
    assert shares["localized"] == pytest.approx(0.5, abs=0.03)


def test_turns_of_a_scanner_go_in() -> None:
    policy = Follower()
    ranges, tick = bytes(2 * RAYS), at(0)
    scan = LaserScan(sensor="laser", ranges=ranges, bearing=0.0, step=-0.01, duration=0.1, since_tick=0.0, tick=tick)
    through(policy, None, samples=[(SCAN, "laser", scan, 0)])
    assert policy.heard == ["laser"]


def test_the_error_is_by_the_truth_on_the_map() -> None:
    driven = through(Follower(), read_room(ROOM))
    assert driven.truth.doubt == ""
    assert driven.errors.distances == pytest.approx((0.03, 0.03, 0.03))
    assert driven.errors.newest is not None
    assert driven.errors.newest.state == "localized"


def test_it_begins_where_it_is_said_to() -> None:
    policy = Follower()
    driven = through(policy, None, Pose(1.5, 2.2, 0.0))
    assert policy.told is not None
    assert (policy.told.x, policy.told.y) == (1.5, 2.2)
    assert driven.shares.shares == {"localized": 1.0}
    assert driven.errors.newest is None


def test_a_jump_of_odometry_is_no_way_and_ends_what_is_known_of_the_truth() -> None:
    samples = drive(2.0)
    for _, _, sample, ms in drive(2.0):
        if isinstance(sample, Odometry):
            jumped = stamped(odometry(ms * MS, 7.0 + SPEED * ms), ms, 0, "another")
            samples.append((ODOM, "", jumped, ms + 2100))
    driven = through(Follower(), read_room(ROOM), samples=samples)
    assert driven.way == pytest.approx(2.0)
    assert driven.truth.doubt == "odometry began anew on the way, or its pose was set"


def test_a_truth_through_a_wall_is_of_another_room() -> None:
    room = Room("cell", Start(0.0, 0.0, 0.0))
    room.add_wall("end", [(1.0, -1.0), (1.0, 1.0)])
    driven = through(Follower(), room)
    assert driven.truth.doubt.startswith("it would lead through a wall")
    told = summarize(driven, "sim-test", took=0.0)
    assert driven.errors.newest is not None
    assert told.localization.error is None, "what was compared before is of that room, too"
    assert max(map(len, to_text(told).splitlines())) <= 80
    assert TrueWay(None).doubt == "this map does not say where a run starts on it"


def recorded(path: Path, said: list[tuple[Topic[Any], str, Sample, int]]) -> Path:
    """Write a recording of these, with the table of the robot."""
    table = tomllib.loads((ROOT / "deploy" / "robot.toml").read_text())["robot"]
    with RecordingWriter(path, ABOUT | {"tables": json.dumps({"robot": table})}) as writer:
        for topic, name, sample, ms in said:
            key = key_of("sim-test", topic).replace("*", name)
            writer.add([RawSample(ms * MS, key, encode(sample), str(encoding_of(topic.schema)))])
        writer.close("test")
    return path


OTHER = (BASE, "", stamped(base(), 0, 0, "b"), 4000)
"""More than is needed."""


@pytest.fixture
def recording(tmp_path: Path) -> Path:
    """Of that drive."""
    return recorded(tmp_path / "drive.mcap", [*drive(), OTHER])


BOX = ((0.0, 0.0, 6.0, 0.0), (6.0, 0.0, 6.0, 5.0), (6.0, 5.0, 0.0, 5.0), (0.0, 5.0, 0.0, 0.0))


@pytest.fixture
def follower(monkeypatch: pytest.MonkeyPatch) -> Follower:
    policy = Follower()
    monkeypatch.setattr(offline, "LocalizationPolicy", lambda *_: policy)
    monkeypatch.setattr(offline, "read_map", lambda path: FloorPlan(path.stem, BOX))
    return policy


def test_a_recording_is_summed_up(recording: Path, follower: Follower, giraff: Giraff) -> None:
    words = ("localize", "--from", str(recording), "--map", str(ROOM))
    code, out, complaint = giraff(*words)
    assert (code, complaint) == (0, "")
    assert "of sim-test, 4.0 s, " in out
    assert "times faster than real time" in out
    assert "way  2.00 m by odometry" in out
    assert "localized at x 3.50 y 2.23 m, 0.0°" in out
    assert "0.030 m, 0.0° median" in out
    assert follower.heard.count("odom") == 401
    code, out, complaint = giraff(*words, "--at", "1.5,2.2,0deg", "--json")
    assert (code, complaint) == (0, "")
    told = json.loads(out)
    assert (told["robot"], told["way_m"], told["doubt"]) == ("sim-test", 2.0, "")
    assert told["localization"]["shares"] == {"localized": 1.0}
    assert told["localization"]["error"]["worst_m"] == 0.03


def test_a_map_without_room_for_the_robot_is_none(
    recording: Path, monkeypatch: pytest.MonkeyPatch, giraff: Giraff
) -> None:
    monkeypatch.setattr(offline, "read_map", lambda path: FloorPlan(path.stem, BOX[:1]))
    code, out, complaint = giraff("localize", "--from", str(recording), "--map", str(ROOM))
    assert (code, out) == (2, "")
    assert complaint.startswith(f"giraff: {ROOM}: ")
    assert "no room for a robot" in complaint


@pytest.mark.usefixtures("follower")
def test_without_a_room_the_truth_is_left_out(recording: Path, giraff: Giraff, tmp_path: Path) -> None:
    code, out, _ = giraff("localize", "--from", str(recording), "--map", str(tmp_path / "x.yaml"))
    assert code == 0
    assert "off by" not in out
    assert "truth  not told: this map does not say where a run starts on it" in out


@pytest.mark.parametrize("as_json", [(), ("--json",)])
def test_a_place_that_is_refused_is_no_summary(
    as_json: tuple[str, ...], recording: Path, follower: Follower, giraff: Giraff
) -> None:
    follower.refuses = "that is in a wall"
    words = ("--from", str(recording), "--map", str(ROOM), "--at", "1,2,3rad")
    assert giraff("localize", *words, *as_json) == (1, "", "giraff: --at: that is in a wall\n")


@pytest.mark.usefixtures("follower")
def test_a_recording_without_odometry_says_so(giraff: Giraff, tmp_path: Path) -> None:
    path = recorded(tmp_path / "base.mcap", [OTHER])
    code, out, complaint = giraff("localize", "--from", str(path), "--map", str(ROOM))
    assert (code, out) == (2, "")
    assert "it has no odom, and so no way; record odom and range/* or scan/*" in complaint


@pytest.mark.parametrize("content", [b"", b"\x89MCAP0\r\n torn", None])
@pytest.mark.usefixtures("follower")
def test_a_file_that_is_no_recording_is_one_line(content: bytes | None, giraff: Giraff, tmp_path: Path) -> None:
    path = tmp_path / "drive.mcap"
    if content is not None:
        path.write_bytes(content)
    code, out, complaint = giraff("localize", "--from", str(path), "--map", str(ROOM))
    assert (code, out) == (2, "")
    [line] = complaint.splitlines()
    assert str(path) in line
