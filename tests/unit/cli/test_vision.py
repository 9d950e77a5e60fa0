"""`giraff vision --from` and `giraff replay`: a short drive before the simulated camera, recorded and as a video."""

import json
from collections.abc import Iterator
from functools import cache
from itertools import islice
from pathlib import Path
from typing import Any, Final
from unittest.mock import MagicMock

import cv2
import pytest

from giraff_mcap.raw_sample import RawSample
from giraff_mcap.writing import RecordingWriter
from giraff_schemas.camera import VisualOdometry
from giraff_schemas.codec import encode, encoding_of, stamped
from giraff_schemas.messages import Odometry, Sample
from giraff_schemas.topics import CAMERA, ODOM, VISUAL_ODOM, Topic, key_of
from giraff_sim.camera.scene import Scene
from giraff_vision.policy import VisionPolicy
from tests.rules.repository import ROOT
from tests.support.filmed_drive import CAMERA as HEAD
from tests.support.filmed_drive import Filmed, film
from tests.unit.cli.typed import Giraff
from tests.unit.mcap.recordings import ABOUT

ROBOT: Final = ROOT / "deploy" / "robot.toml"
MS: Final = 1_000_000


@cache
def drive() -> list[Filmed]:
    """Film the begin of a drive. Its first pictures are left out: they are before the first word of the wheels."""
    return [*islice(film("straight", Scene(floor="planks"), 1.1), 50)][3:]


@cache
def said() -> list[VisualOdometry]:
    """Return what is told of each of its pictures."""
    policy, told = VisionPolicy(HEAD), list[VisualOdometry]()
    for number, shot in enumerate(drive()):
        for each in shot.odometry:
            policy.on_odometry(heard(each, number))
        told.append(policy.on_picture(shot.picture, shot.grey))
    return told


def heard(odometry: Odometry, number: int) -> Odometry:
    """Return it as it comes before the picture of this number."""
    return stamped(odometry, odometry.seq, (number + 1) * 67 * MS - 1, "odometry")


@pytest.fixture
def giraff(monkeypatch: pytest.MonkeyPatch, giraff: Giraff, tmp_path: Path) -> Giraff:
    monkeypatch.setenv("GIRAFF_CONFIG", str(ROBOT))
    monkeypatch.chdir(tmp_path)
    return giraff


def recorded(path: Path, pictures: int, missing: int = -1) -> str:
    """Write a recording of the begin of the drive that lacks the picture of this number."""

    def samples() -> Iterator[tuple[int, Topic[Any], Sample]]:
        for number, shot in enumerate(drive()[:pictures]):
            at_ns = (number + 1) * 67 * MS
            for each in shot.odometry:
                yield at_ns - 1, ODOM, heard(each, number)
            if number != missing:
                yield at_ns, CAMERA.at("head"), shot.picture
            yield at_ns + 1, VISUAL_ODOM, stamped(said()[number], number, at_ns, "vision")

    with RecordingWriter(path, ABOUT | {"robot": "anne"}) as writer:
        writer.add(
            [RawSample(at, key_of("anne", topic), encode(s), encoding_of(type(s))) for at, topic, s in samples()]
        )
        writer.close("test")
    return path.name


def test_a_recording_is_looked_through_with_its_wheels(giraff: Giraff, tmp_path: Path) -> None:
    shots = drive()[:27]
    code, out, complaint = giraff("vision", "--from", recorded(tmp_path / "a.mcap", len(shots)), "--json")
    assert (code, complaint) == (0, "")
    told = json.loads(out)
    assert (told["camera"], told["pictures"], told["without_wheels"]) == ("head", len(shots), 0)
    assert told["measured"] >= 0.95 * len(shots)
    assert told["measured"] + sum(told["reasons"].values()) == len(shots)
    assert told["by_camera"]["x"] == pytest.approx(shots[-1].pose.x, rel=0.02)
    assert told["by_wheels"]["x"] == pytest.approx(shots[-1].wheels.x, rel=0.01)


def test_a_video_has_no_wheels_and_one_that_is_cut_off_is_told(giraff: Giraff, tmp_path: Path) -> None:
    """Its pictures are larger than the robot file says, as a camera's may be."""
    path, shots = tmp_path / "a.avi", drive()[:27]
    video = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), 15.0, (640, 480))
    for shot in shots:
        video.write(cv2.cvtColor(cv2.resize(shot.grey, (640, 480)), cv2.COLOR_GRAY2BGR))
    video.release()
    code, out, complaint = giraff("vision", "--from", "a.avi", "--json")
    told = json.loads(out)
    assert (code, complaint, told["width"], told["by_wheels"]) == (0, "", 320, None)
    assert told["by_camera"]["x"] == pytest.approx(shots[-1].pose.x, rel=0.03)
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    code, out, complaint = giraff("vision", "--from", "a.avi")
    assert code == 1
    assert "by the wheels  not heard" in out
    assert f"of its {len(shots)} pictures can be read; this is of what came before" in complaint


def test_a_video_of_huge_pictures_is_refused_before_one_is_decoded(
    giraff: Giraff, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "a.mp4").touch()
    video = MagicMock(read=MagicMock(side_effect=AssertionError("a picture was decoded")))
    video.get.side_effect = {cv2.CAP_PROP_FRAME_WIDTH: 16_384.0, cv2.CAP_PROP_FRAME_HEIGHT: 16_384.0}.get
    monkeypatch.setattr(cv2, "VideoCapture", lambda _: video)
    code, _, complaint = giraff("vision", "--from", "a.mp4")
    assert (code, "its pictures have 16384 x 16384 px" in complaint) == (2, True)


def test_a_replay_goes_on_at_a_key_picture_behind_a_missing_one_and_sees_what_is_otherwise(
    giraff: Giraff, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    count = len(drive())

    def replay(name: str) -> dict[str, Any]:
        found: list[dict[str, Any]] = json.loads(giraff("replay", name, "--json")[1])
        return next(each for each in found if each["service"] == "vision")

    whole = replay(recorded(tmp_path / "whole.mcap", count))
    assert (whole["equal"], whole["compared"], whole["left_out"]) == (count - 1, count - 1, 1)
    part = replay(recorded(tmp_path / "part.mcap", count, missing=3))
    assert (part["first"], part["equal"] + part["left_out"]) == ("", count)
    assert 20 < part["equal"] < count - 20
    monkeypatch.setenv("GIRAFF_ROBOT_SENSORS__HEAD__Z", "1.05")
    assert "motion" in replay(recorded(tmp_path / "begin.mcap", 8))["first"]
