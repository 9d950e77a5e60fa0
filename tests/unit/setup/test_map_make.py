"""`giraff map make`: a plan of a drive, live and recorded, and where it is written."""

import json
import os
import signal
import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import msgspec
import pytest
from PIL import Image

from giraff_core.robot import RobotConfig
from giraff_maps.read import read_map
from giraff_maps.room_file import read_room_file
from giraff_mcap.raw_sample import RawSample
from giraff_mcap.writing import RecordingWriter
from giraff_node.process.state import write_file_durably
from giraff_schemas.codec import encode, encoding_of, stamped
from giraff_schemas.localization import MapWalls
from giraff_schemas.messages import Sample
from giraff_schemas.scan import LaserScan
from giraff_schemas.topics import MAP, SCAN, Topic, key_of
from giraff_schemas.trouble import Trouble
from giraff_setup.map.make import files, finish
from giraff_setup.map.make.drive import Drive
from tests.support.robots import ROBOT
from tests.support.scan_drives import SCANNER, drive
from tests.support.scan_worlds import home
from tests.unit.cli.typed import Giraff, giraff
from tests.unit.maps.grids import off
from tests.unit.mcap.recordings import ABOUT, BEGAN_NS

__all__ = ["giraff"]

NAMES = ["home.pgm", "home.toml", "home.yaml"]
MAPPED = msgspec.structs.replace(ROBOT, sensors={**ROBOT.sensors, "laser": SCANNER})
ROUTE = [(1.5, 2.2), (1.5, 1.4), (3.0, 1.4), (3.6, 2.9), (2.2, 3.2), (1.5, 2.2), (1.5, 1.4), (3.0, 1.4)]
"""Round the living room, and on where it came before."""
SCANS = drive(home("living_room"), 1, route=ROUTE).scans
ROUND = 140
"""Scans of the way round."""


def with_all(scans: Sequence[LaserScan], **fields: Any) -> list[LaserScan]:
    return [msgspec.structs.replace(scan, **fields) for scan in scans]


def names(folder: str) -> list[str]:
    return sorted(path.name for path in Path(folder).iterdir())


def recorded(path: Path, scans: Sequence[Sample], robot: RobotConfig = MAPPED, topic: Topic[Any] = SCAN) -> Path:
    writer = RecordingWriter(path, ABOUT | {"tables": msgspec.json.encode({"robot": robot}).decode()})
    with writer:
        for number, scan in enumerate(scans):
            key = key_of("sim-test", SCAN.at(scan.sensor) if isinstance(scan, LaserScan) else topic)
            writer.add(
                [
                    RawSample(
                        BEGAN_NS + number * 100_000_000,
                        key,
                        encode(stamped(scan, number, 0, "s")),
                        encoding_of(type(scan)),
                    )
                ]
            )
        writer.close("test")
    return path


def driven(scans: Sequence[LaserScan] = SCANS[:ROUND]) -> Drive:
    made = Drive(MAPPED)
    for scan in scans:
        made.add(scan)
    return made


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return the folder in which a person is. Home and temporary files are beside it."""
    monkeypatch.setenv("HOME", str(tmp_path / "me"))
    monkeypatch.setattr("tempfile.gettempdir", lambda: str(tmp_path / "tmp"))
    for name in ("here", "me", "tmp"):
        (tmp_path / name).mkdir()
    monkeypatch.chdir(tmp_path / "here")
    return tmp_path / "here"


def test_a_recorded_drive_becomes_a_grid_and_a_room_that_are_read(folder: Path, giraff: Giraff) -> None:
    recorded(folder / "drive.mcap", SCANS)
    code, out, complaint = giraff("map", "make", "home.toml", "--from", "drive.mcap", "--json")
    told = json.loads(out)
    assert (code, complaint, told["good"], told["scanner"]) == (0, "", True, "laser")
    assert names(".") == ["drive.mcap", *NAMES]
    room, grid = (read_map(Path(f"home.{ending}")) for ending in ("toml", "yaml"))
    assert room.name == "home"
    assert room.bounds == pytest.approx((told["x"][0], told["y"][0], told["x"][1], told["y"][1]), abs=0.002)
    assert max(off(room.walls, grid.walls, 0.2)) < 0.15
    left, bottom, right, top = room.bounds
    assert 5.9 < right - left < 6.3
    assert 5.9 < top - bottom < 6.3
    way = read_room_file(Path("home.toml")).waypoints
    assert len(way) > 5
    assert all(left < x < right and bottom < y < top for x, y in way)
    shades = Image.open("home.pgm").histogram()
    assert min(shades[0], shades[205], shades[254]) > 100
    assert sum(shades) == shades[0] + shades[205] + shades[254]
    assert giraff("map", "make", "home", "--from", "drive.mcap")[::2] == (
        2,
        "giraff: home.yaml is there already: name another file, or delete it first\n",
    )


def test_what_a_drive_saw_is_redrawn_and_all_else_stays(folder: Path, giraff: Giraff) -> None:
    recorded(folder / "drive.mcap", SCANS)
    room = (Path(__file__).parents[3] / "deploy/worlds/living_room.toml").read_text(encoding="utf-8")
    moved = 'name = "moved away"\npoints = [[3.0, 2.0], [3.4, 2.0], [3.4, 2.4], [3.0, 2.4]]\nclosed = true\n'
    cellar = 'name = "cellar"\npoints = [[9.0, 0.0], [12.0, 0.0], [12.0, 3.0], [9.0, 3.0]]\nclosed = true\n'
    Path("home.toml").write_text(f"{room}\n[[walls]]\n{moved}\n[[walls]]\n{cellar}", encoding="utf-8")
    code, out, complaint = giraff("map", "make", "home", "--onto", "--from", "drive.mcap", "--json")
    assert (code, complaint, json.loads(out)["good"]) == (0, "", True)
    kept, *others = (name for name in names(".") if name not in {*NAMES, "drive.mcap"})
    assert (kept.startswith("home.toml.before-"), others, "cellar" in Path(kept).read_text(encoding="utf-8")) == (
        True,
        [],
        True,
    )
    (kept_room := Path("kept.toml")).write_bytes(Path(kept).read_bytes())
    walls, true = read_map(Path("home.toml")).walls, read_map(kept_room).walls
    assert max(off(walls, true, 0.2)) < 0.06
    assert sum(wall[0] > 8.0 for wall in walls) == 4
    assert not [wall for wall in walls if 2.9 < wall[0] < 3.5 and 1.9 < wall[1] < 2.5]
    assert read_map(Path("home.yaml")).bounds.right == pytest.approx(12.0, abs=0.1)
    other = f'name = "x"\nstart = {{ x = 0.0, y = 0.0, yaw_deg = 0.0 }}\n[[walls]]\n{cellar}'
    Path("home.toml").write_text(other, encoding="utf-8")
    code, _, complaint = giraff("map", "make", "home", "--onto", "--from", "drive.mcap")
    assert (code, complaint.split(":")[1:]) == (
        1,
        [" home stays as it was", " it fits 'x' badly", " another plan, or much has moved; the plan is home-2.toml\n"],
    )


def test_a_plan_that_cannot_be_redrawn_stays_and_the_drive_is_kept(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert folder.name == "here"
    made, before = driven(), 'name = "x"\nstart = { x = 0.0, y = 0.0, yaw_deg = 0.0 }\n'
    room = (Path(__file__).parents[3] / "deploy/worlds/living_room.toml").read_text(encoding="utf-8")
    one_wall = f'{before}[[walls]]\nname = "w"\npoints = [[0.0, 0.0], [6.0, 0.0]]\n'
    write = write_file_durably

    def full(path: Path, data: bytes) -> None:
        if path.name == ".h😀.toml.new":
            raise OSError(28, "No space left on device", str(path))
        write(path, data)

    monkeypatch.setattr(files, "write_file_durably", full)
    for number, (plan, cause) in enumerate([(room, "No space left"), (one_wall, "it fits 'x'")], 2):
        Path("h😀.toml").write_text(plan, encoding="utf-8")
        wish = finish.wish_of(Path("h😀"), onto=True, calibrate=False, file=None)
        assert finish.finish(made, "robie", wish, as_json=True) == 1
        assert cause in capsys.readouterr().err
        assert Path("h😀.toml").read_text(encoding="utf-8") == plan
        assert read_map(Path(f"h😀-{number}.yaml")).walls
    assert not [name for name in names(".") if name.endswith(".new")]


def test_a_good_plan_tells_the_robot_file_wheels_and_track(
    folder: Path, giraff: Giraff, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot_file = folder / "robot.toml"
    filed = (Path(__file__).parents[3] / "deploy/robot.toml").read_text(encoding="utf-8")
    robot_file.write_text(filed.replace('name = "giraff"', 'name = "sim-test"', 1), encoding="utf-8")
    monkeypatch.setenv("GIRAFF_CONFIG", str(robot_file))
    true = drive(home("living_room"), 5, hz=5.0, spin=0.0)
    recorded(folder / "drive.mcap", true.scans)
    code, out, complaint = giraff("map", "make", "home", "--from", "drive.mcap", "--calibrate")
    assert (code, complaint) == (0, "")
    assert f"Written: [robot.calibration] of {robot_file}; as it was before: {robot_file}.before-" in out
    told = tomllib.loads(robot_file.read_text(encoding="utf-8"))["robot"]["calibration"]
    wheels = (told["left_wheel_scale"] + told["right_wheel_scale"]) / 2.0
    assert wheels == pytest.approx(true.forward_scale, rel=0.005)
    # Slip in turns makes up to 2 % of a turn, the more the faster it is.
    assert wheels / told["track_scale"] == pytest.approx(true.turn_scale, rel=0.02)
    recorded(folder / "short.mcap", true.scans[:60])
    code, _, complaint = giraff("map", "make", "short", "--from", "short.mcap", "--calibrate")
    assert (code, "the plan is not good, so that it tells nothing of the wheels" in complaint) == (1, True)
    monkeypatch.setenv("GIRAFF_CONFIG", str(folder / "none.toml"))
    assert giraff("map", "make", "none", "--from", "drive.mcap", "--calibrate")[0] == 2
    assert not Path("none.toml").exists()


def test_a_plan_that_lacks_something_is_written_and_says_what(folder: Path, giraff: Giraff) -> None:
    recorded(folder / "drive.mcap", SCANS[:60])
    code, out, _ = giraff("map", "make", "a home", "--from", "drive.mcap")
    assert code == 1
    assert "verdict  only 1." in out
    assert "\n           no place was seen a second time" in out
    assert "next  giraff map show 'a home.toml'\n           giraff localize --map 'a home.toml'\n" in out
    assert read_map(Path("a home.toml")).walls


@pytest.mark.parametrize(
    ("scans", "robot", "complaint"),
    [
        ([], MAPPED, "drive.mcap: it has no scan/*; record a drive with `giraff record` while giraff_scan runs"),
        (SCANS[:9], ROBOT, "sim-test has no laser scanner in its robot file; write [robot.sensors.laser]"),
        (with_all(SCANS[:9], odom=None), MAPPED, "the scans come without odometry; check that giraff_odometry runs"),
        (with_all(SCANS[:9], ranges=bytes(900)), MAPPED, "laser sees no walls; drive where they are within its reach"),
        (with_all(SCANS[:9], trouble=Trouble("laser stalls")), MAPPED, "laser stalls. Nothing was written"),
        (
            with_all(SCANS[:9], sensor="x"),
            MAPPED,
            "a scanner x is heard, and the robot file has none of this name; give it this name",
        ),
    ],
)
def test_a_recording_of_no_drive_writes_nothing(
    folder: Path, giraff: Giraff, scans: list[LaserScan], robot: RobotConfig, complaint: str
) -> None:
    if scans:
        recorded(folder / "drive.mcap", scans, robot)
    else:
        recorded(folder / "drive.mcap", [MapWalls(map="hall", walls=())], robot, MAP)
    code, out, error = giraff("map", "make", "home", "--from", "drive.mcap")
    assert (code, out) == (2, "")
    assert complaint in error
    assert names(".") == ["drive.mcap"]


@pytest.mark.parametrize(
    ("name", "complaint"),
    [
        ("rooms", "rooms is a folder: give the plan a name in it, like rooms/home"),
        ("none/home", "none/home.yaml cannot be written: there is no such folder; make it"),
        (".", "is a folder"),
        ("x" * 300, "is too long: give one of 200 characters at most"),
    ],
)
def test_a_name_that_cannot_be_is_told_before_anybody_drives(
    folder: Path, giraff: Giraff, name: str, complaint: str
) -> None:
    (folder / "rooms").mkdir()
    code, _, error = giraff("map", "make", name)
    assert code == 2
    assert complaint in error


def test_another_scanner_is_left_out_and_the_first_that_tells_anything_counts() -> None:
    made = Drive(msgspec.structs.replace(MAPPED, sensors=MAPPED.sensors | {"rear": MAPPED.sensors["laser"]}))
    for scan in (*with_all(SCANS[:3], trouble=Trouble("stalls")), *with_all(SCANS[:20], sensor="rear"), *SCANS[:3]):
        made.add(scan)
    assert (made.scanner, made.others, str(made.trouble)) == ("rear", {"laser"}, "")


def test_a_drive_is_not_lost_where_its_name_or_its_folder_is_gone(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    made = driven()
    stem = files.stem_of(Path("home"))
    (folder / "home.pgm").write_text("mine")
    assert finish.finish(made, "robie", finish.Wish(stem, None, False), as_json=True) in {0, 1}
    assert "giraff: home was taken meanwhile; the plan is home-2.toml" in capsys.readouterr().err
    assert names(".") == ["home-2.pgm", "home-2.toml", "home-2.yaml", "home.pgm"]
    write = write_file_durably

    def full(path: Path, data: bytes) -> None:
        if path.suffix == ".toml" and path.parent.name in {"", "me"}:
            raise OSError(28, "No space left on device", str(path))
        write(path, data)

    monkeypatch.setattr(files, "write_file_durably", full)
    finish.finish(made, "robie", finish.Wish(Path("flat"), None, False), as_json=True)
    assert "giraff: flat.toml: cannot be written: No space left on device; the plan is" in capsys.readouterr().err
    assert names("../tmp") == ["flat.pgm", "flat.toml", "flat.yaml"]
    assert names("../me") == []
    assert len(names(".")) == 4
    monkeypatch.setattr(files, "write_file_durably", lambda path, _: write(path / "x", b""))
    assert finish.finish(made, "robie", finish.Wish(Path("flat"), None, False), as_json=True) == 2
    assert "nor in the home folder" in capsys.readouterr().err


def test_a_second_ctrl_c_writes_nothing_and_a_closed_terminal_does(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    made = driven()
    plan = made.plan

    def interrupted(number: signal.Signals) -> Any:
        for part in plan():
            os.kill(os.getpid(), number)
            yield part

    monkeypatch.setattr(made, "plan", lambda: interrupted(signal.SIGINT))
    assert finish.finish(made, "robie", finish.Wish(folder / "home", None, False), as_json=True) == 2
    assert capsys.readouterr().err == "giraff: ended by a second Ctrl-C. Nothing was written\n"
    assert names(".") == []
    monkeypatch.setattr(made, "plan", lambda: interrupted(signal.SIGHUP))
    assert finish.finish(made, "robie", finish.Wish(folder / "home", None, False), as_json=True) in {0, 1}
    assert names(".") == NAMES
