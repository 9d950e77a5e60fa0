"""`giraff frames` beside a running robot."""

from __future__ import annotations

import re

import pytest

from giraff_cli.frames import Frames, dot, faults_of
from giraff_schemas.frames import Transform
from tests.support.desk import Desk
from tests.support.robots import ROBOT
from tests.support.talker import talker


def frame(parent: str, child: str) -> Transform:
    return Transform(parent=parent, child=child, x=0.0, y=0.0, yaw=0.0, fixed=True)


def test_the_tree_goes_from_odom_to_the_sensors(desk: Desk) -> None:
    found = desk.json("frames")
    places = {told["child"]: told for told in found["frames"]}
    assert set(places) == {"base_link", "range_front_left_link", "range_front_right_link", "range_rear_link"}
    assert (places["base_link"]["parent"], places["base_link"]["fixed"]) == ("odom", False)
    for sensor, pose in ROBOT.sensors.items():
        told = places[f"range_{sensor}_link"]
        assert (told["parent"], told["fixed"]) == ("base_link", True)
        assert (told["x"], told["y"], told["yaw"]) == pytest.approx((pose.x, pose.y, pose.yaw))
    assert found["faults"] == []


def test_it_is_drawn(desk: Desk) -> None:
    text = desk.run("frames").stdout
    assert text.startswith("odom\n└── base_link  x 0.000 m, y 0.000 m, yaw ")
    assert re.search(r"^    └── range_rear_link  x -0.250 m, y 0.000 m, yaw 180.0°$", text, re.MULTILINE)
    drawn = desk.run("frames", "--dot").stdout
    assert '"odom" -> "base_link" [label=' in drawn
    assert '"base_link" -> "range_rear_link" [label="x -0.250 m, y 0.000 m, yaw 180.0°"];' in drawn


def test_a_robot_of_which_nobody_tells_is_named(desk: Desk) -> None:
    with talker(desk.rendezvous, "sim-nowhere"):
        done = desk.run("frames", "--robot", "sim-nowhere")
    assert (done.returncode, done.stdout) == (2, "")
    [line] = done.stderr.splitlines()
    assert "nobody tells where the frames of sim-nowhere are" in line


@pytest.mark.parametrize(
    ("told", "said"),
    [
        ([frame("odom", "base_link"), frame("base_link", "rear")], []),
        ([frame("odom", "base_link"), frame("map", "base_link")], ["in map and in odom", "map, odom are in none"]),
        ([frame("base_link", "rear")], []),
        ([frame("odom", "base_link"), frame("chassis", "rear")], ["hang together nowhere: chassis, odom"]),
        ([frame("a", "b"), frame("b", "a")], ["they are in each other"]),
    ],
)
def test_what_is_no_tree_is_told(told: list[Transform], said: list[str]) -> None:
    faults = faults_of(told)
    assert len(faults) == len(said)
    assert all(words in fault for words, fault in zip(said, faults, strict=True))


def test_a_name_may_hold_anything() -> None:
    drawn = dot(Frames(robot='a"b', frames=[frame('x"', "y\\")], faults=[]))
    assert drawn.splitlines()[0] == 'digraph "a\\"b" {'
    assert '"x\\"" -> "y\\\\"' in drawn
