"""The whole way from the first mark to the robot file, in simulated time."""

import os
import shutil
import socket
import tomllib
from pathlib import Path
from typing import Any

import msgspec
import pytest

from giraff_core.kinematics.calibration import Calibration
from giraff_core.robot import RobotConfig
from giraff_core.senses import typed
from giraff_node.config.robot_file import ConfigError
from giraff_node.network.discovery import simulated_name
from giraff_setup.wheels.odometry.calibrate import guide
from giraff_setup.wheels.odometry.plan import PLAN
from giraff_sim.board import ROOT
from giraff_tools.robot_file import own_robot_file
from tests.unit.setup.person import Act, Person
from tests.unit.setup.taped import TapedRobot

SIMULATED = simulated_name(socket.gethostname())


@pytest.fixture
def taped() -> TapedRobot:
    return TapedRobot(5)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return Path(shutil.copy(ROOT / "deploy" / "robot.toml", tmp_path / "robot.toml"))


def table(path: Path) -> dict[str, Any]:
    return typed(tomllib.loads(path.read_text(encoding="utf-8"))["robot"])


def guided(person: Person, taped: TapedRobot, path: Path, robot: str = "giraff") -> int:
    return guide(person, taped, robot, msgspec.convert(table(path), RobotConfig), path, force=False)


def test_what_was_found_is_written_and_the_file_before_is_kept(taped: TapedRobot, path: Path) -> None:
    before = path.read_text(encoding="utf-8")
    person = Person(taped, {("Write", 1): "perhaps"})
    assert guided(person, taped, path) == 0
    assert person.count("Write") == 2
    found = msgspec.convert(table(path)["calibration"], Calibration)
    assert found.scales == pytest.approx(taped.true_scales, abs=0.004)
    assert found.end_error_after < found.end_error_before / 3.0
    kept = [each for each in path.parent.iterdir() if each != path]
    assert [each.read_text() for each in kept] == [before]
    assert "restart" in person.told[-1]
    assert "giraff doctor" in person.told[-1]


def test_a_simulated_robot_goes_by_it_once_it_is_started_again(taped: TapedRobot, path: Path) -> None:
    person = Person(taped)
    assert guided(person, taped, path, SIMULATED) == 0
    assert "end `giraff run` and start it again" in person.told[-1]
    assert not any("services" in text for text in person.told)


@pytest.mark.parametrize("robot", [SIMULATED, "anne"])
def test_the_file_of_another_robot_is_not_written_unless_somebody_names_it(
    path: Path, monkeypatch: pytest.MonkeyPatch, robot: str
) -> None:
    monkeypatch.setenv("GIRAFF_CONFIG", str(path))
    monkeypatch.setenv("GIRAFF_ROBOT_NAME", robot)
    assert own_robot_file("giraff", None)[0] == path
    with pytest.raises(ConfigError, match=f"is the robot file of giraff, and {robot} is heard; .*--file FILE"):
        own_robot_file(robot, None)
    monkeypatch.delenv("GIRAFF_CONFIG")
    assert own_robot_file(robot, path)[0] == path


CHECKS = [number for number, leg in enumerate(PLAN, 1) if leg.is_check]
REFUSED: dict[str, tuple[dict[tuple[str, int], Act | str], str]] = {
    "no": ({("Write", 1): "no"}, "not wanted"),
    "n": ({("Write", 1): "n"}, "not wanted"),
    "no check": ({("Mark", number): "skip" for number in CHECKS}, "judge"),
    "it makes it worse": ({("ahead", number): "5.5" for number in range(1, 5)}, "refused"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_nothing_is_written_unasked_unchecked_or_for_the_worse(
    taped: TapedRobot, path: Path, capsys: pytest.CaptureFixture[str], case: str
) -> None:
    instead, told = REFUSED[case]
    before = path.read_text(encoding="utf-8")
    assert guided(Person(taped, instead), taped, path) == 1
    assert told in capsys.readouterr().err
    assert path.read_text(encoding="utf-8") == before
    assert list(path.parent.iterdir()) == [path]


def test_a_robot_file_that_is_not_there_is_refused_before_anything_is_driven(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("GIRAFF_CONFIG", str(tmp_path / "none.toml"))
    with pytest.raises(ConfigError, match="no robot file"):
        own_robot_file("giraff", None)


def test_a_robot_file_that_cannot_be_written_is_too(monkeypatch: pytest.MonkeyPatch, path: Path) -> None:
    monkeypatch.setenv("GIRAFF_CONFIG", str(path))
    assert own_robot_file("giraff", None)[0] == path
    monkeypatch.setattr(os, "access", lambda place, _: place != path.parent)
    with pytest.raises(ConfigError, match="cannot be written"):
        own_robot_file("giraff", None)
