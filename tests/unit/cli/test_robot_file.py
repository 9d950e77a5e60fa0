"""A check writes its fields into the robot file, and nothing else."""

import os
import tomllib
from pathlib import Path

import pytest

from giraff_sim.board import ROOT
from giraff_tools.robot_file import RobotFileError, Value, record, record_all, rehearse, still_overriding

FIELDS: dict[str, Value] = {"swap_motors": True, "swap_encoders": False}


@pytest.fixture
def path(tmp_path: Path) -> Path:
    copy = tmp_path / "robot.toml"
    copy.write_bytes((ROOT / "deploy" / "robot.toml").read_bytes())
    copy.chmod(0o640)
    return copy


def test_fields_are_added_and_changed_and_all_else_stays(path: Path) -> None:
    before = path.read_text(encoding="utf-8")
    record(path, "robot", FIELDS)
    record(path, "robot", {"swap_motors": False})
    after = path.read_text(encoding="utf-8")
    assert [line for line in before.splitlines() if line not in after.splitlines()] == []
    tables, was = tomllib.loads(after), tomllib.loads(before)
    assert tables["robot"] == was["robot"] | FIELDS | {"swap_motors": False}
    assert {**tables, "robot": None} == {**was, "robot": None}
    assert path.stat().st_mode & 0o777 == 0o640
    assert os.listdir(path.parent) == ["robot.toml"]  # noqa: PTH208


def test_a_link_stays_a_link(path: Path) -> None:
    link = path.with_name("link.toml")
    link.symlink_to(path)
    record(link, "robot", FIELDS)
    assert link.is_symlink()
    assert tomllib.loads(path.read_text(encoding="utf-8"))["robot"]["swap_motors"] is True


def test_line_ends_stay_what_they_were(path: Path) -> None:
    before = path.read_bytes().replace(b"\n", b"\r\n")
    path.write_bytes(before)
    kept = record(path, "robot.calibration", CALIBRATION, kept_as=KEPT)
    assert kept is not None
    assert kept.read_bytes() == before
    record(path, "robot", FIELDS)
    after = path.read_bytes()
    assert after.count(b"\r\n") == after.count(b"\n") > before.count(b"\n")
    assert [line for line in before.splitlines(keepends=True) if line not in after.splitlines(keepends=True)] == []


SPOILED: dict[str, tuple[str, dict[str, dict[str, Value]]]] = {
    "no table above": ("[robot]\n[base]\n", {"base.drive.speed_control": {"speed_p": 60.0}}),
    "no table": ("base = 3\n", {"base.drive": {"a": 1.0}}),
    "a list": ("[robot]\nsensors = [1]\n", {"robot.sensors.rear": {"x": 1.0}}),
}


@pytest.mark.parametrize("case", SPOILED)
def test_a_rehearsal_refuses_what_recording_would_and_changes_nothing(path: Path, case: str) -> None:
    text, tables = SPOILED[case]
    path.write_text(text, encoding="utf-8")
    with pytest.raises(RobotFileError):
        record_all(path, tables)
    with pytest.raises(RobotFileError, match=r"takes no \[.*\]: .*; write it, and the table above it, as tables"):
        rehearse(path, tables)
    assert path.read_text(encoding="utf-8") == text


OVERRIDING = [
    ("joystick", "mount_yaw", "GIRAFF_JOYSTICK_MOUNT_YAW"),
    ("base.drive", "swap_motors", "GIRAFF_BASE_DRIVE__SWAP_MOTORS"),
    ("base.drive.speed_control", "speed_p", "GIRAFF_BASE_DRIVE__SPEED_CONTROL__SPEED_P"),
    ("base.drive.speed_control", "speed_p", "GIRAFF_BASE_DRIVE__SPEED_CONTROL"),
    ("robot.sensors.rear", "yaw", "GIRAFF_ROBOT_SENSORS__REAR__YAW"),
]


@pytest.mark.parametrize(("table", "field", "variable"), OVERRIDING)
def test_a_variable_that_overrides_what_was_written_is_named(table: str, field: str, variable: str) -> None:
    others = {"GIRAFF_CONFIG": "x", "GIRAFF_ROBOT_NAME": "x", "GIRAFF_BASE_DRIVE__MAX_LEVEL": "7", "ROBOT_SENSORS": "x"}
    tables: dict[str, dict[str, Value]] = {table: {field: 1.0}}
    assert still_overriding(tables, {**others, variable: "1"}).endswith(f"override it: {variable}.")
    assert not still_overriding(tables, others)


CALIBRATION: dict[str, Value] = {
    "date": "2026-11-25",
    "track_scale": 1.01,
    "covariance": [1e-6, 0.0, 0.0, 1e-6, 0.0, 2e-6],
}
KEPT = "before-2026-11-25"


def test_a_table_that_is_missing_is_made_and_the_file_before_it_is_kept(path: Path) -> None:
    before = path.read_text(encoding="utf-8")
    kept = record(path, "robot.calibration", CALIBRATION, kept_as=KEPT)
    after = path.read_text(encoding="utf-8")
    assert kept is not None
    assert kept == path.with_name("robot.toml.before-2026-11-25")
    assert kept.read_text() == before
    assert kept.stat().st_mode & 0o777 == 0o640
    assert "\n\n[robot.calibration]\n" in after
    start = after.index("\n[robot.calibration]\n") + 1
    assert after.startswith(before[:start])  # all that is above it, and all that is below
    assert after.endswith(before[start:])
    was = tomllib.loads(before)
    assert tomllib.loads(after) == {**was, "robot": {**was["robot"], "calibration": CALIBRATION}}


def test_a_table_that_is_there_is_changed_in_place_and_no_copy_is_overwritten(path: Path) -> None:
    path.write_text(
        path.read_text(encoding="utf-8").replace("[network]", '[robot.calibration]\ndate = "x" # by hand\n\n[network]'),
        encoding="utf-8",
    )
    texts = [path.read_text(encoding="utf-8")]
    for number in range(3):
        record(path, "robot.calibration", {**CALIBRATION, "track_scale": 1.0 + number}, kept_as=KEPT)
        texts.append(path.read_text(encoding="utf-8"))
    assert 'date = "2026-11-25" # by hand\n' in texts[-1]
    names = ("robot.toml.before-2026-11-25", "robot.toml.before-2026-11-25-2", "robot.toml.before-2026-11-25-3")
    assert [path.with_name(name).read_text() for name in names] == texts[:3]


@pytest.mark.parametrize(
    "text",
    ["[robot]\na = 1\n[base]\nb = 2\n[robot.sensors]\nc = 3 # c\n", "[robot]\na = 1 # a\n", "robot.a = 1\n[x]\n"],
)
def test_a_table_finds_its_place_in_any_file(path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8")
    record(path, "robot.calibration", CALIBRATION)
    was, tables = tomllib.loads(text), tomllib.loads(path.read_text(encoding="utf-8"))
    assert tables == {**was, "robot": {**was["robot"], "calibration": CALIBRATION}}
    assert [line for line in text.splitlines() if line not in path.read_text(encoding="utf-8").splitlines()] == []


@pytest.mark.parametrize(
    ("table", "fields", "text"),
    [
        *(("robot", FIELDS, text) for text in (b"[robot", b"name = 'x'", b"robot = 3", b"[robot] # \xff\n")),
        *(("robot.calibration", CALIBRATION, text) for text in (b"robot = {a = 1}\n", b"[base]\n", b"[robot")),
        ("robot.calibration", CALIBRATION, b"[robot]\ncalibration = 3\n"),
    ],
)
def test_a_file_without_a_place_for_the_table_is_left_alone(
    path: Path, table: str, fields: dict[str, Value], text: bytes
) -> None:
    path.write_bytes(text)
    first = {"robot": "swap_motors = true", "robot.calibration": 'date = "2026-11-25"'}[table]
    with pytest.raises(RobotFileError, match=rf"into \[{table}\] by hand:\n    {first}\n"):
        record(path, table, fields, kept_as=KEPT)
    assert path.read_bytes() == text
    assert os.listdir(path.parent) == ["robot.toml"]  # noqa: PTH208


@pytest.mark.parametrize("calls", [0, 1, 2, 3])
def test_a_disk_that_fills_up_on_the_way_leaves_the_file_and_no_copy(
    path: Path, monkeypatch: pytest.MonkeyPatch, calls: int
) -> None:
    before = path.read_text(encoding="utf-8")
    done: list[int] = []

    def full(descriptor: int) -> None:
        done.append(descriptor)
        if len(done) > calls:
            raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(RobotFileError, match="No space left on device"):
        record(path, "robot.calibration", CALIBRATION, kept_as=KEPT)
    if calls < 3:  # the fourth is the folder, with the file in it already
        assert path.read_text(encoding="utf-8") == before
        assert os.listdir(path.parent) == ["robot.toml"]  # noqa: PTH208
