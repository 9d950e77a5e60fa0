"""A check writes its fields into the robot file, and nothing else."""

from __future__ import annotations

import os
import tomllib
from pathlib import Path

import pytest

from giraff_cli.check.robot_file import RobotFileError, record
from giraff_sim.board import ROOT

FIELDS = {"swap_motors": True, "swap_encoders": False}


@pytest.fixture
def path(tmp_path: Path) -> Path:
    copy = tmp_path / "robot.toml"
    copy.write_bytes((ROOT / "deploy" / "robot.toml").read_bytes())
    copy.chmod(0o640)
    return copy


def test_fields_are_added_and_changed_and_all_else_stays(path: Path) -> None:
    before = path.read_text()
    record(path, "robot", FIELDS)
    record(path, "robot", {"swap_motors": False})
    after = path.read_text()
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
    assert tomllib.loads(path.read_text())["robot"]["swap_motors"] is True


@pytest.mark.parametrize("text", ["[robot", "name = 'x'", "robot = 3"])
def test_a_file_that_does_not_hold_the_table_is_left_alone(path: Path, text: str) -> None:
    path.write_text(text)
    with pytest.raises(RobotFileError, match=r"write into \[robot\] by hand:\n    swap_motors = true"):
        record(path, "robot", FIELDS)
    assert path.read_text() == text


def test_a_disk_that_does_not_take_it_leaves_the_file_as_it_was(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    before = path.read_text()

    def full(_descriptor: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(RobotFileError, match="No space left on device"):
        record(path, "robot", FIELDS)
    assert path.read_text() == before
    assert os.listdir(path.parent) == ["robot.toml"]  # noqa: PTH208
