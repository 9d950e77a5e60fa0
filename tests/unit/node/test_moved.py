"""What stood in [robot] and stands in [base.drive] now: files and variables of before mean the same."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import pytest
import tomlkit

from giraff_base.config import BaseConfig
from giraff_base.drives.wheels.config import WheelsConfig
from giraff_core.robot import RobotConfig
from giraff_node.config.moved import current_name
from giraff_node.config.robot_file import ConfigError, load, read
from giraff_schemas.trouble import Trouble
from giraff_sim.board import ROOT

DRIVE: dict[str, Any] = {
    "max_level": 60,
    "stall_level": 20,
    "wheel_control": "speed",
    "speed_control": {"max_pwm": 111, "stall_pwm": 41},
    "battery_volts_per_count": 0.03,
    "battery_nominal": 25.0,
    "swap_motors": True,
    "swap_encoders": False,
    "invert_left_motor": True,
    "invert_right_motor": False,
    "invert_left_encoder": True,
    "invert_right_encoder": False,
}
"""No field as it is by default."""
NEW = tomllib.loads((ROOT / "deploy" / "robot.toml").read_text(encoding="utf-8"))
NEW["base"]["drive"] = {"type": "wheels", **DRIVE}


def written(folder: Path, tables: dict[str, Any], **variables: str) -> dict[str, str]:
    """Write a robot file, and return the environment that names it."""
    path = folder / "robot.toml"
    path.write_text(tomlkit.dumps(tables), encoding="utf-8")
    return {"GIRAFF_CONFIG": str(path), **variables}


def old(*fields: str) -> dict[str, Any]:
    """Return tables in which these fields stand where they stood before."""
    drive = {name: value for name, value in NEW["base"]["drive"].items() if name not in fields}
    if drive == {"type": "wheels"}:
        drive = {}
    robot = NEW["robot"] | {name: DRIVE[name] for name in fields}
    base = {name: value for name, value in NEW["base"].items() if name != "drive"}
    return NEW | {"robot": robot, "base": base | ({"drive": drive} if drive else {})}


def meant(given: dict[str, str]) -> tuple[BaseConfig, RobotConfig]:
    return load("base", BaseConfig, given), load("robot", RobotConfig, given)


@pytest.mark.parametrize(
    "fields", [tuple(DRIVE), *((name,) for name in DRIVE)], ids=lambda names: f"{len(names)}-{names[0]}"
)
def test_a_file_of_before_means_the_same_and_says_what_to_write(tmp_path: Path, fields: tuple[str, ...]) -> None:
    expected = meant(written(tmp_path, NEW))
    assert read(written(tmp_path, NEW)).moved == ()
    given = written(tmp_path, old(*fields))
    assert meant(given) == expected
    [told] = read(given).moved
    assert told.what.endswith(f"[robot] has {', '.join(fields)}")
    assert told.remedy == "write that into [base.drive], as deploy/robot.toml does"


@pytest.mark.parametrize("field", DRIVE)
def test_a_field_in_both_places_is_refused(tmp_path: Path, field: str) -> None:
    tables = old(field)
    given = written(tmp_path, tables | {"base": NEW["base"]})
    with pytest.raises(ConfigError, match=rf"\[robot\] and \[base.drive\] both have {field}; remove that from \[robot"):
        load("network", RobotConfig, given)


@pytest.mark.parametrize("field", DRIVE)
def test_a_variable_of_before_overrides_files_of_both_kinds(tmp_path: Path, field: str) -> None:
    expected = meant(written(tmp_path, NEW))
    variable, name = f"GIRAFF_ROBOT_{field.upper()}", f"GIRAFF_BASE_DRIVE__{field.upper()}"
    text = tomlkit.item(DRIVE[field]).as_string().strip('"')
    if field == "speed_control":
        text = "{ max_pwm = 111, stall_pwm = 41 }"
    assert current_name(variable) == current_name(name) == name
    default = {"max_level": 70, "battery_volts_per_count": 0.0}.get(field)
    without = {each: value for each, value in NEW["base"]["drive"].items() if each != field}
    for drive in (without, without if default is None else without | {field: default}):
        for each in (variable, name):
            given = written(tmp_path, NEW | {"base": NEW["base"] | {"drive": drive}}, **{each: text})
            assert meant(given) == expected
            told = (Trouble(f"{variable} has another name now", f"write {name}"),)
            assert read(given).moved == (told if each == variable else ())
    given = written(tmp_path, old(*DRIVE), **{variable: text})
    assert meant(given) == expected
    with pytest.raises(ConfigError, match=f"{variable} and {name} set the same field; remove {variable}"):
        meant(given | {name: text})


def test_two_underscores_go_into_a_table_whether_before_or_now(tmp_path: Path) -> None:
    for prefix in ("GIRAFF_ROBOT_", "GIRAFF_BASE_DRIVE__"):
        given = written(tmp_path, NEW, **{f"{prefix}SPEED_CONTROL__MAX_PWM": "99"})
        drive = load("base", BaseConfig, given).drive
        assert isinstance(drive, WheelsConfig)
        assert (drive.speed_control.max_pwm, drive.speed_control.stall_pwm) == (99, 41)
    given = written(tmp_path, NEW, GIRAFF_BASE_DRIVE__MAX_LEVEL__X="3")
    with pytest.raises(ConfigError, match="GIRAFF_BASE_DRIVE__MAX_LEVEL__X: cannot be set: max_level is no table"):
        meant(given)


@pytest.mark.parametrize(
    ("drive", "told"),
    [
        (None, "there is no [base.drive]; say what moves the robot, as deploy/robot.toml does"),
        ({"type": "whels", **DRIVE}, "did you mean 'wheels'?"),
        ({"type": 3, **DRIVE}, "drive.type must be text, and is a number"),
        ({"type": "wheels", "max_levl": 70}, "unknown field `max_levl` in drive; did you mean 'max_level'?"),
        (
            {"type": "wheels", **DRIVE, "wheel_control": "sped"},
            "drive.wheel_control cannot be 'sped'; did you mean 'speed'?",
        ),
        ({"type": "wheels", **DRIVE, "speed_control": {"max_pmw": 3}}, "did you mean 'max_pwm'?"),
        (3, "drive must be a table of fields, and is a number"),
    ],
)
def test_what_is_wrong_in_base_drive_is_named_with_the_word_that_was_meant(
    tmp_path: Path, drive: object, told: str
) -> None:
    base = {name: value for name, value in NEW["base"].items() if name != "drive"}
    given = written(tmp_path, NEW | {"base": base if drive is None else base | {"drive": drive}})
    with pytest.raises(ConfigError) as refused:
        load("base", BaseConfig, given)
    assert told in str(refused.value)
    assert load("robot", RobotConfig, given).name == "giraff"


@pytest.mark.parametrize("base", [{"drive": 3}, 3])
def test_a_file_of_before_with_no_table_where_one_belongs_is_refused_and_does_not_crash(
    tmp_path: Path, base: object
) -> None:
    with pytest.raises(ConfigError, match="base"):
        load("base", BaseConfig, written(tmp_path, old(*DRIVE) | {"base": base}))
    with pytest.raises(ConfigError, match=r"is no table|a value where the table"):
        load("base", BaseConfig, written(tmp_path, NEW | {"base": base}, GIRAFF_ROBOT_MAX_LEVEL="3"))
