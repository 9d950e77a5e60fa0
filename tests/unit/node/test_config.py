"""The robot file and the environment: strict, and every refusal says where and what instead."""

import re
from pathlib import Path

import msgspec
import pytest

from giraff_base.config import BaseConfig
from giraff_core.access import AccessConfig
from giraff_core.network import NetworkConfig
from giraff_core.robot import RobotConfig
from giraff_core.senses import Ultrasonic
from giraff_guard.config import GuardConfig
from giraff_node.config.robot_file import ConfigError, load, robot_file
from giraff_node.network.discovery import Target, resolve_target
from giraff_sim.board import ROOT
from giraff_tools.robot_file import record


class Settings(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    port: str
    operator_budget: float = 0.4
    retries: int = 3
    pauses: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        if self.operator_budget <= 0.0:
            raise ValueError(f"operator_budget is {self.operator_budget}: it must be a positive number")


def environment(directory: Path, text: str, **variables: str) -> dict[str, str]:
    path = directory / "robot.toml"
    path.write_text(text)
    return {"GIRAFF_CONFIG": str(path), "HOME": "/", **variables}


def refusal(given: dict[str, str]) -> str:
    with pytest.raises(ConfigError) as refused:
        load("base", Settings, given)
    return str(refused.value)


def test_defaults_stand_for_what_is_left_out(tmp_path: Path) -> None:
    settings = load("base", Settings, environment(tmp_path, '[base]\nport = "/dev/x"'))
    assert settings == Settings(port="/dev/x", operator_budget=0.4, retries=3)


def test_the_environment_overrides_the_file(tmp_path: Path) -> None:
    given = environment(
        tmp_path, '[base]\nport = "/dev/x"', GIRAFF_BASE_PORT="/dev/y", GIRAFF_BASE_OPERATOR_BUDGET="0.3"
    )
    assert load("base", Settings, given) == Settings(port="/dev/y", operator_budget=0.3)


@pytest.mark.parametrize(
    ("text", "variables", "says"),
    [
        ('[base]\nport = "x"\noperator_budgt = 1', {}, "did you mean 'operator_budget'?"),
        ('[bas]\nport = "x"', {}, "unknown table [bas]; did you mean 'base'?"),
        ('base = "x"', {}, "base is a value where the table [base] belongs"),
        ("[base", {}, "not TOML: at the end: ] is missing"),
        ("[base]\nport = x", {}, "not TOML: line 2, column 8: a value is missing, or is text without quotes"),
        ('[base]\nport = "x"\nport = "y"', {}, "a name stands there twice"),
        ("[base]\nport = 3", {}, "port must be text, and is a number"),
        (
            '[base]\nport = "x"',
            {"GIRAFF_BASE_RETRIES": "18446744073709551616"},
            "is beyond 64 bits: no message can hold",
        ),
        ('[base]\nport = "x"\nretries = "many"', {}, "retries must be a whole number, and is text"),
        ('[base]\nport = "x"\noperator_budget = 0', {}, "it must be a positive number"),
        ("[base]", {}, "`port` is missing"),
        ('[base]\nport = "x"', {"GIRAFF_BASE_PRT": "y"}, "did you mean 'port'?"),
        ('[base]\nport = "x"', {"GIRAFF_BASE_PRT": "y"}, "with GIRAFF_BASE_PRT of the environment"),
        ('[base]\nport = "x"', {"GIRAFF_BASE_OPERATOR_BUDGET": "nan-ish"}, "with GIRAFF_BASE_OPERATOR_BUDGET of"),
        ('[base]\nport = "x"', {"GIRAFF_BASE_OPERATOR_BUDGET": "0,3"}, "and is text ('0,3'); write 0.3"),
        ('[base]\nport = "x"\noperator_budget = "0,3"', {}, "must be a number, and is text ('0,3'); write 0.3"),
        ('[base]\nport = "x"\noperator_budget = "wide"', {}, "must be a number, and is text ('wide')"),
        ('[base]\nport = "x"', {"GIRAFF_BASE_RETRIES": "0,3"}, "must be a whole number, and is text ('0,3'); write it"),
        ('[base]\nport = "x"', {"GIRAFF_BASE_OPERATOR_BUDGET": ".3"}, "is text ('.3'); write 0.3"),
        ('[base]\nport = "x"', {"GIRAFF_BASE_OPERATOR_BUDGET": "30cm"}, "is text ('30cm'); write it like 0.3"),
        ('[base]\nport = "x"', {"GIRAFF_BASE_OPERATOR_BUDGET": ""}, "is text (''); write it like 0.3"),
        ('[base]\nport = "x"\npauses = ["0,3"]', {}, "pauses 1 must be a number, and is text"),
        ('[base]\nport = "x"', {"GIRAFF_BASE_": "y"}, "GIRAFF_BASE_: names no field"),
        ('[base]\nport = "x"', {"GIRAFF_HOME": "y"}, "GIRAFF_HOME: names no field"),
        ('[base]\nport = "x"\n[base.deeper]\na = 1', {}, "unknown field `deeper`"),
        ('[base]\nport = "x"', {"GIRAFF_BAES_PORT": "y"}, "GIRAFF_BAES_PORT: names no field"),
        ('[base]\nport = "x"', {"GIRAFF_BASE": "y"}, "GIRAFF_BASE: names no field"),
        ('[base]\nport = "x"', {"GIRAFF_BASE_RETRIES": "lots"}, "retries must be a whole number, and is text"),
    ],
)
def test_what_cannot_be_used_is_refused(tmp_path: Path, text: str, variables: dict[str, str], says: str) -> None:
    assert says in refusal(environment(tmp_path, text, **variables))


def test_an_error_of_the_file_is_not_blamed_on_the_environment(tmp_path: Path) -> None:
    given = environment(tmp_path, '[base]\nport = "x"\nretries = "many"', GIRAFF_ROBOT_NAME="r", PATH="/bin")
    assert "environment" not in refusal(given)


def test_a_table_that_is_missing_is_one_of_defaults_only(tmp_path: Path) -> None:
    given = environment(tmp_path, "")
    assert load("network", NetworkConfig, given) == NetworkConfig()
    assert "`port` is missing" in refusal(given)


def test_truths_and_numbers_of_the_environment_are_read_from_their_text(tmp_path: Path) -> None:
    for text, truth in (("true", True), ("false", False), ("1", True), ("0", False)):
        given = environment(tmp_path, "[network]", GIRAFF_NETWORK_LOCAL=text)
        assert load("network", NetworkConfig, given).local is truth


def test_a_list_from_the_environment(tmp_path: Path) -> None:
    given = environment(tmp_path, "", GIRAFF_NETWORK_CONNECT='["192.0.2.1", "192.0.2.2:7448"]')
    assert load("network", NetworkConfig, given).connect == ("192.0.2.1", "192.0.2.2:7448")
    with pytest.raises(ConfigError, match="GIRAFF_NETWORK_CONNECT: not a list"):
        load("network", NetworkConfig, {**given, "GIRAFF_NETWORK_CONNECT": "[tcp"})
    for text, advice in (
        ("192.168.1.20, b", '["192.168.1.20","b"]'),
        ("192.168.1.20, ", '["192.168.1.20"]'),
        *((text, '["192.168.1.20:7447"]') for text in ("robot:abc", "", "'a', 'b'")),
    ):
        with pytest.raises(ConfigError, match=rf"is text \(.*\); write {re.escape(advice)}$"):
            load("network", NetworkConfig, {**given, "GIRAFF_NETWORK_CONNECT": text})


def test_quotes_and_blanks_around_a_value_of_the_environment_are_no_part_of_it(tmp_path: Path) -> None:
    variables = {"PORT": '"/dev/y"', "OPERATOR_BUDGET": "'0.3 '", "RETRIES": '"5"\r'}
    given = environment(tmp_path, "", **{f"GIRAFF_BASE_{field}": text for field, text in variables.items()})
    assert load("base", Settings, given) == Settings(port="/dev/y", operator_budget=0.3, retries=5)
    given |= {"GIRAFF_ROBOT_NAME": '"anne"', "GIRAFF_NETWORK_CONNECT": """ '["192.0.2.1"]'\r"""}
    assert resolve_target(None, (), given) == Target("anne", NetworkConfig(connect=("192.0.2.1",)))


def test_a_table_from_the_environment(tmp_path: Path) -> None:
    """Written as in the file, on one line: any field can be set."""
    given = environment(tmp_path, "", GIRAFF_GUARD_PRIORITIES="{ joystick = 1, child = -1 }")
    assert load("guard", GuardConfig, given).priorities == {"joystick": 1, "child": -1}
    given = environment(tmp_path, "", GIRAFF_NETWORK_ACCESS='{ robot = ["pc"], operators = { laptop = ["joystick"] } }')
    assert load("network", NetworkConfig, given).access == AccessConfig(
        robot=("pc",), operators={"laptop": ("joystick",)}
    )
    for broken in ("{ joystick = }", "{ joystick }", "{", "{} and more", "{}\nx = 3", "{}\n[x]"):
        with pytest.raises(ConfigError, match="GIRAFF_GUARD_PRIORITIES: not a table"):
            load("guard", GuardConfig, environment(tmp_path, "", GIRAFF_GUARD_PRIORITIES=broken))
    with pytest.raises(ConfigError, match="with GIRAFF_GUARD_PRIORITIES of the environment"):
        load("guard", GuardConfig, environment(tmp_path, "", GIRAFF_GUARD_PRIORITIES="{ joystick = 'high' }"))


def test_a_missing_file_is_named_with_the_way_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ConfigError, match="unless GIRAFF_CONFIG names another"):
        robot_file({})
    with pytest.raises(ConfigError, match=r"nowhere\.toml"):
        robot_file({"GIRAFF_CONFIG": "nowhere.toml"})


def test_a_byte_order_mark_is_no_part_of_a_robot_file(tmp_path: Path) -> None:
    given = environment(tmp_path, '\ufeff[base]\nport = "x"\n')
    record(tmp_path / "robot.toml", "base", {"retries": 5})
    assert load("base", Settings, given) == Settings(port="x", retries=5)
    assert (tmp_path / "robot.toml").read_bytes().startswith(b"\xef\xbb\xbf[base]")


@pytest.mark.parametrize("content", [b"\xff\xfe", b"\x00"])
def test_a_file_that_is_no_text_is_refused(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "robot.toml"
    path.write_bytes(content)
    assert "not TOML" in refusal({"GIRAFF_CONFIG": str(path)})


def test_the_robot_file_of_the_tree_is_sound() -> None:
    given = {"GIRAFF_CONFIG": str(ROOT / "deploy" / "robot.toml")}
    robot = load("robot", RobotConfig, given)
    assert set(robot.of(Ultrasonic)) == {"front_left", "front_right", "rear"}
    assert load("network", NetworkConfig, given).rendezvous == "127.0.0.1:7447"


@pytest.mark.parametrize(
    ("variable", "value", "says"),
    [
        ("GIRAFF_ROBOT_TRACK_WIDTH", "-1", "track_width is -1"),
        ("GIRAFF_ROBOT_TRACK_WIDTH", "nan", "track_width is nan"),
        ("GIRAFF_ROBOT_MAX_LEVEL", "70", "unknown field `max_level`; known are: calibration, footprint_radius, frames"),
        ("GIRAFF_BASE_DRIVE__MAX_LEVEL", "300", "max_level is 300"),
        ("GIRAFF_BASE_DRIVE__MAX_LEVEL", "0", "max_level is 0"),
        ("GIRAFF_BASE_DRIVE__MAX_LEVEL__X", "3", "GIRAFF_BASE_DRIVE__MAX_LEVEL__X: cannot be set: max_level is no"),
        ("GIRAFF_BASE_DRIVE__SPEED_CONTROL__MAX_PWM", "256", "max_pwm is 256: it must be within 1..255"),
        ("GIRAFF_BASE_DRIVE__BATTERY_VOLTS_PER_COUNT", "nan", "battery_volts_per_count is nan"),
        ("GIRAFF_BASE_DRIVE__BATTERY_VOLTS_PER_COUNT", "-0.1", "battery_volts_per_count is -0.1"),
        ("GIRAFF_BASE_DRIVE__SWAP_MOTORS", "perhaps", "swap_motors"),
        ("GIRAFF_BASE_DRIVE__WHEEL_CONTROL", "speeds", "wheel_control"),
        ("GIRAFF_BASE_DRIVE__BATTERY_NOMINAL", "0", "battery_nominal is 0"),
        ("GIRAFF_BASE_DRIVE__SPEED_CONTROL", "{ max_pwm = 256 }", "max_pwm is 256: it must be within 1..255"),
        ("GIRAFF_BASE_DRIVE__SPEED_CONTROL", "{ stall_pwm = 111 }", "stall_pwm is 111: it must be max_pwm at most"),
        ("GIRAFF_BASE_DRIVE__SPEED_CONTROL", "{ stal_pwm = 30 }", "unknown field `stal_pwm`"),
        ("GIRAFF_BASE_DRIVE__SPEED_CONTROL", "{ speed_p = nan }", "speed_p is nan"),
        ("GIRAFF_ROBOT_NAME", "a/b", "cannot be part of a key"),
        ("GIRAFF_ROBOT_NAME", "", "cannot be part of a key"),
    ],
)
def test_a_robot_that_cannot_be_is_refused(variable: str, value: str, says: str) -> None:
    given = {"GIRAFF_CONFIG": str(ROOT / "deploy" / "robot.toml"), variable: value}
    with pytest.raises(ConfigError, match=says):
        load("base", BaseConfig, given) if "BASE" in variable else load("robot", RobotConfig, given)


@pytest.mark.parametrize(
    ("drive", "says"),
    [
        ("", "there is no [base.drive]; say what moves the robot, as deploy/robot.toml does"),
        ('drive = { type = "whels" }', "did you mean 'wheels'?"),
        ("drive = { type = 3 }", "drive.type must be text, and is a number"),
        ('drive = { type = "wheels", max_levl = 7 }', "unknown field `max_levl` in drive; did you mean 'max_level'?"),
        (
            'drive = { type = "wheels", wheel_control = "sped" }',
            "wheel_control cannot be 'sped'; did you mean 'speed'?",
        ),
        ('drive = { type = "wheels", speed_control = { max_pmw = 3 } }', "did you mean 'max_pwm'?"),
        ("drive = 3", "drive must be a table of fields, and is a number"),
    ],
)
def test_what_is_wrong_in_base_drive_is_named_with_the_word_that_was_meant(
    tmp_path: Path, drive: str, says: str
) -> None:
    with pytest.raises(ConfigError) as refused:
        load("base", BaseConfig, environment(tmp_path, f'[base]\nport = "x"\n{drive}'))
    assert says in str(refused.value)


@pytest.mark.parametrize(
    ("was", "becomes", "says"),
    [
        ("index = 1", "index = 0", "sensors share an index"),
        ("index = 1", "index = 3", "the ranger board has 0..2"),
        ("index = 1", "index = -1", "the ranger board has 0..2"),
        ("index = 1", "indx = 1", "unknown field `indx`"),
        ("x = 0.25", "x = nan", "x is nan"),
        ("yaw = 3.141592653589793", "yaw = 180", "sensors.rear: yaw is 180: it must be within"),
        ("y = -0.15", 'y = "left"', "sensors.front_right.y must be a number"),
        ("yaw = 0.0", "yaw = inf", "yaw is inf"),
        ("[robot.sensors.rear]", '[robot.sensors."re ar"]', "cannot be part of a key"),
    ],
)
def test_a_sensor_that_cannot_be_is_refused(tmp_path: Path, was: str, becomes: str, says: str) -> None:
    text = (ROOT / "deploy" / "robot.toml").read_text()
    assert was in text
    with pytest.raises(ConfigError) as refused:
        load("robot", RobotConfig, environment(tmp_path, text.replace(was, becomes, 1)))
    assert says in str(refused.value)
