"""What the numbers of a robot file can be: each has a range, and a slip is named with its likely cause."""

import math
import tomllib
from pathlib import Path
from typing import get_type_hints

import msgspec
import pytest

from giraff_base.config import BaseConfig
from giraff_base.drives.wheels.config import SpeedControl, WheelsConfig
from giraff_core.bounds import Bounds, bounds_of
from giraff_core.kinematics.parts import PartPose
from giraff_core.robot import RobotConfig
from giraff_core.senses import Camera, Ultrasonic, typed
from giraff_guard.config import GuardConfig
from giraff_joystick.config import JoystickConfig
from giraff_keyboard.config import KeyboardConfig
from giraff_node.config.robot_file import ConfigError, load
from giraff_odometry.config import OdometryConfig
from giraff_recorder.config import RecorderConfig
from giraff_sentry.config import SentryConfig
from giraff_sim.board import ROOT
from giraff_sim.config import SimConfig
from giraff_sim.truth import TruthRanges

DEPLOYED = tomllib.loads((ROOT / "deploy" / "robot.toml").read_text())
TABLES: dict[str, type[msgspec.Struct]] = {
    "robot": RobotConfig,
    "base": BaseConfig,
    "base.drive": WheelsConfig,
    "guard": GuardConfig,
    "joystick": JoystickConfig,
    "keyboard": KeyboardConfig,
    "odometry": OdometryConfig,
    "recorder": RecorderConfig,
    "sentry": SentryConfig,
}
ELSEWHERE = {
    "index": "0..2, and each once",
    "dead_zone_deg": "grows to the next, and 90",
    "full_tilt_deg": "likewise",
    "first_step": "1..steps",
}
"""Fields whose range depends on others."""
RANGES = [(table, name, within) for table, config in TABLES.items() for name, within in bounds_of(config).items()]


def convert(table: str, **fields: object) -> msgspec.Struct:
    values = DEPLOYED
    for name in table.split("."):
        values = values.get(name, {})
    if table == "robot":
        values = typed(values)
    return msgspec.convert({**values, **fields}, TABLES[table], strict=False)


@pytest.mark.parametrize("config", [*TABLES.values(), Ultrasonic, Camera, PartPose, SpeedControl, TruthRanges])
def test_each_number_has_a_range(config: type[msgspec.Struct]) -> None:
    hints = get_type_hints(config)
    numbers = {name for name, hint in hints.items() if hint in (int, float, float | None)}
    assert numbers - ELSEWHERE.keys() == bounds_of(config).keys()


def refused(table: str, **fields: object) -> str:
    with pytest.raises(msgspec.ValidationError) as told:
        convert(table, **fields)
    return str(told.value)


@pytest.mark.parametrize(("table", "name", "within"), RANGES)
def test_what_is_outside_is_refused(table: str, name: str, within: Bounds) -> None:
    """By text, too, as of the environment."""
    low, high = within.low, within.high
    is_whole = get_type_hints(TABLES[table])[name] is int
    outside = [low - 1, high + 1] if is_whole else [low - 1e-3, high * 1.001, math.inf, -math.inf, math.nan, 1e300]
    for value in outside:
        for given in (value, str(value)):
            assert f"{name} is {value:.10g}: it must be within " in refused(table, **{name: given})


@pytest.mark.parametrize(("table", "name", "within"), RANGES)
def test_what_stands_by_default_is_far_from_the_ends(table: str, name: str, within: Bounds) -> None:
    """A robot that is twice or half of it is sensible, too."""
    value = getattr(convert(table), name)
    if value and name not in ("max_level", "stall_level"):
        assert within.low <= value / 2.0
        assert value * 2.0 <= within.high


@pytest.mark.parametrize(
    ("table", "was", "becomes", "told"),
    [
        (
            "robot",
            "yaw = 3.141592653589793",
            "yaw = 180",
            "180: it must be within -2π..2π rad; are these degrees? 180 degrees are 3.1416 rad",
        ),
        ("robot", "yaw = 0.0", "yaw = -90.0", "-90: it must be within -2π..2π rad; are these degrees?"),
        ("robot", "x = 0.25", "x = 250", "250: it must be within -2..2 m; are these millimetres?"),
        ("robot", "footprint_radius = 0.30", "footprint_radius = 0.0001", "0.0001: it must be within 0.03..2 m"),
        ("robot", "footprint_radius = 0.30", "footprint_radius = 300", "within 0.03..2 m; are these millimetres?"),
        ("robot", "ticks_per_metre = 2002.0594", "ticks_per_metre = 2", "1/m; are these counts per millimetre?"),
        ("robot", "max_angular_speed = 1.57", "max_angular_speed = 90", "rad/s; are these degrees a second?"),
        (
            "guard",
            "[guard]",
            "[guard]\ndeceleration = 1e9",
            "1000000000: it must be within 0.05..10 m/s²; are these mill",
        ),
        ("guard", "[guard]", "[guard]\nmargin = 250", "250: it must be within 0.01..2 m; are these millimetres?"),
        ("guard", "[guard]", "[guard]\nhalf_cone = 7.5", "7.5: it must be within 0.001..π/4 rad; are these degrees?"),
        (
            "base",
            "[base]",
            "[base]\nlinear_acceleration = 1e9",
            "1000000000: it must be within 0.01..10 m/s²; are these",
        ),
        ("base", "[base]", "[base]\nguard_budget = 200", "it must be within 0.02..2 s; are these milliseconds?"),
        ("odometry", "[odometry]", "[odometry]\nlost_yaw = 20.0", "it must be within 0..2π rad; are these degrees?"),
    ],
)
def test_a_slip_is_named_with_its_likely_cause(tmp_path: Path, table: str, was: str, becomes: str, told: str) -> None:
    path = tmp_path / "robot.toml"
    text = (ROOT / "deploy" / "robot.toml").read_text()
    assert was in text
    path.write_text(text.replace(was, becomes, 1))
    with pytest.raises(ConfigError) as refusal:
        load(table, TABLES[table], {"GIRAFF_CONFIG": str(path)})
    name, _, value = becomes.rpartition("\n")[2].partition(" = ")
    assert str(refusal.value).startswith(f"{path}: table [{table}]: ")
    assert f": {name} is {float(value):.10g}: it must be within " in str(refusal.value)
    assert told in str(refusal.value)


@pytest.mark.parametrize(
    "fields",
    [
        {"track_width": 0.08, "footprint_radius": 0.06, "max_wheel_speed": 0.8, "max_angular_speed": 20.0},
        {"track_width": 1.8, "footprint_radius": 1.6, "max_wheel_speed": 3.0, "max_angular_speed": 0.2},
        {"ticks_per_metre": 196.0},  # a disc of 20 slots on the axle of a wheel of 65 mm
        {"ticks_per_metre": 160_000.0},  # 2 x 2048 counts a turn of a motor, geared 12:1, on a wheel of 100 mm
    ],
)
def test_a_sensible_robot_is_not_refused(fields: dict[str, float]) -> None:
    assert isinstance(convert("robot", **fields), RobotConfig)


@pytest.mark.parametrize("yaw", [3.1416, -3.1416, 4.712389, 2 * math.pi])
def test_a_rounded_half_turn_is_one(yaw: float) -> None:
    assert Ultrasonic(index=0, x=-0.25, y=0.0, yaw=yaw).yaw == yaw


@pytest.mark.parametrize(
    ("name", "value", "told"),
    [
        ("sonar_noise", 100, "100: it must be within 0..0.5 m; are these millimetres?"),
        ("threshold_slip", 50, "50: it must be within 0..0.1 m; are these millimetres?"),
        (
            "accelerometer_offset",
            1e6,
            "1000000: it must be within 0..2 m/s²; are these milli",
        ),
        ("sensor_yaw", 3, "3: it must be within 0..π/6 rad; are these degrees?"),
        ("calibrated_track_scale", 0.04, "0.04: it must be 0.03 at most"),
    ],
)
def test_a_truth_that_cannot_be_is_refused(name: str, value: float, told: str) -> None:
    with pytest.raises(msgspec.ValidationError) as refused:
        msgspec.convert({"truth": {name: value}}, SimConfig)
    assert f"{name} is {told}" in str(refused.value)


def test_a_wheel_must_be_able_to_count_as_stuck() -> None:
    convert("base.drive", stall_level=70)
    told = "stall_level is 71 and max_level 70: no wheel would ever count as stuck; it must be max_level at most"
    assert told in refused("base.drive", stall_level=71)
