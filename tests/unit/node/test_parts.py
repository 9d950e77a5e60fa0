"""The frames of a robot's parts, as its file has them."""

import math
from pathlib import Path

import pytest

from giraff_core.robot import RobotConfig
from giraff_node.config.robot_file import ConfigError, load
from giraff_sim.board import ROOT

DEPLOYED = (ROOT / "deploy" / "robot.toml").read_text()


def robot(directory: Path, tables: str) -> RobotConfig:
    path = directory / "robot.toml"
    path.write_text(DEPLOYED.replace("[network]", f"{tables}\n[network]", 1))
    return load("robot", RobotConfig, {"GIRAFF_CONFIG": str(path)})


def table(name: str, **fields: object) -> str:
    """As TOML."""
    return "\n".join([f"[robot.frames.{name}]", *(f"{key} = {value!r}" for key, value in fields.items()), ""])


def test_parts_stand_on_the_robot_on_sensors_and_on_each_other(tmp_path: Path) -> None:
    found = robot(
        tmp_path,
        table("laser", x=-0.115, z=0.226)
        + table("lens", parent="head", pitch=0.3)
        + table("head", z=1.2)
        + table("shield", parent="range_rear_link"),
    ).frames
    assert {name: part.parent for name, part in found.items()} == {
        "laser": "base_link",
        "lens": "head",
        "head": "base_link",
        "shield": "range_rear_link",
    }
    laser = found["laser"].transform("laser")
    assert (laser.parent, laser.child, laser.x, laser.z, laser.fixed) == ("base_link", "laser", -0.115, 0.226, True)


def test_a_robot_has_none_by_default(tmp_path: Path) -> None:
    assert robot(tmp_path, "").frames == {}


@pytest.mark.parametrize(
    ("tables", "says"),
    [
        (
            table("laser", parent="chassis"),
            "frames.laser has the parent 'chassis', which is no part of the robot: base_li",
        ),
        (table("laser", parent="odom"), "frames.laser has the parent 'odom', which is no part of the robot"),
        (
            table("laser", parent="laser"),
            "frames are in each other: laser in laser; let one of them have another parent",
        ),
        (
            table("a", parent="b") + table("b", parent="c") + table("c", parent="b"),
            "frames are in each other: b in c in b; let",
        ),
        (table("odom"), "frames.odom: odom is odometry's frame already; give it another name"),
        (table("map"), "frames.map: map is the floor plan's frame already; give it another name"),
        (table("base_link"), "base_link is the robot's own frame already"),
        (table("range_rear_link"), "range_rear_link is a sensor's frame already"),
        (table('"la ser"'), "'la ser' cannot be part of a key"),
        (table("laser", yaw=90), "frames.laser: yaw is 90: it must be within -2π..2π rad; are these degrees?"),
        (table("laser", x=-115.0), "x is -115: it must be within -2..2 m"),
        (table("laser", w=1.0), "unknown field `w`"),
    ],
)
def test_what_is_no_tree_of_the_robot_is_refused_in_one_line(tmp_path: Path, tables: str, says: str) -> None:
    with pytest.raises(ConfigError) as refused:
        robot(tmp_path, tables)
    assert says in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_sensor_may_be_tilted_and_still_looks_ahead(tmp_path: Path) -> None:
    tilted = DEPLOYED.replace("index = 2", "index = 2\nz = 0.4\nroll = 3.0\npitch = -0.2", 1)
    path = tmp_path / "robot.toml"
    path.write_text(tilted)
    rear = load("robot", RobotConfig, {"GIRAFF_CONFIG": str(path)}).sensor_transforms["rear"]
    assert (rear.child, rear.z, rear.roll, rear.pitch, rear.yaw) == ("range_rear_link", 0.4, 3.0, -0.2, math.pi)
    path.write_text(tilted.replace("pitch = -0.2", "pitch = -20"))
    with pytest.raises(ConfigError, match=r"pitch is -20: it must be within -π/4\.\.π/4 rad; are these degrees\?"):
        load("robot", RobotConfig, {"GIRAFF_CONFIG": str(path)})
