"""Sensors of a robot file, by their type."""

import math
from array import array
from pathlib import Path
from typing import Any

import msgspec
import pytest

from giraff_core.robot import RobotConfig
from giraff_core.senses import HC_SR04, Bumper, LaserScanner, Ultrasonic, UnknownSensor
from giraff_node.config.robot_file import ConfigError, load
from giraff_schemas.bumper import Bump
from giraff_schemas.messages import Range
from giraff_schemas.scan import NOT_MEASURED, OWN, RAYS, LaserScan, packed
from giraff_schemas.trouble import Trouble
from tests.rules.repository import ROOT

POSE = "index = 0\nx = 0.25\ny = 0.0\nyaw = 0.0\n"


def robot(folder: Path, sensors: str) -> RobotConfig:
    head, _, _ = (ROOT / "deploy" / "robot.toml").read_text().partition("[robot.sensors.")
    file = folder / "robot.toml"
    file.write_text(head + sensors)
    return load("robot", RobotConfig, {"GIRAFF_CONFIG": str(file)})


def test_a_sensor_without_a_type_is_an_ultrasonic_one(tmp_path: Path) -> None:
    other = POSE.replace("index = 0", "index = 1")
    found = robot(tmp_path, f"[robot.sensors.a]\n{POSE}[robot.sensors.b]\ntype = 'hc-sr04'\nreach = 2.0\n{other}")
    assert list(found.of(Ultrasonic)) == ["a", "b"]
    assert found.sensors["a"] == msgspec.structs.replace(HC_SR04, x=0.25)
    assert found.of(Ultrasonic)["b"].reach == 2.0


@pytest.mark.parametrize("unknown", ["rplidar", "unknown"])
def test_each_sensor_is_of_its_type_and_an_unknown_one_is_passed_over(tmp_path: Path, unknown: str) -> None:
    found = robot(
        tmp_path,
        f"[robot.sensors.a]\n{POSE}[robot.sensors.front]\ntype = 'bumper'\nindex = 1\nway = 'forward'\n"
        f"[robot.sensors.laser]\ntype = '{unknown}'\nbaud = 115200\n",
    )
    assert list(found.of(Ultrasonic)) == ["a"]
    assert found.of(Bumper) == {"front": Bumper(index=1, way="forward")}
    assert found.of(UnknownSensor) == {"laser": UnknownSensor(named=unknown)}
    assert found.sensor_types == {"a": "hc-sr04", "front": "bumper"}
    assert list(found.sensor_transforms) == ["a"]
    assert msgspec.convert(msgspec.to_builtins(found), RobotConfig) == found


def test_a_robot_file_without_sensors_is_one_of_a_robot_without_any(tmp_path: Path) -> None:
    assert robot(tmp_path, "").sensor_types == {}


@pytest.mark.parametrize(
    ("entry", "wrong"),
    [
        ("type = 'bumper'\nindex = 2\nway = 'forward'", "the ranger board has bumpers 0..1"),
        ("type = 'bumper'\nindex = 0\nway = 'forwards'", "did you mean 'forward'"),
        ("type = 'bumper'\nindexx = 0\nway = 'forward'", "did you mean 'index'"),
        (f"{POSE}half_cone = 7.5", "half_cone"),
        (f"{POSE}z = -1.0", "z is -1: it must be within 0..2 m; how many metres above the floor is it?"),
        ("type = 'camera'\nz = -1.0", "z is -1: it must be within 0.02..3 m; how high above the floor is its lens?"),
        (
            f"{POSE}type = 3",
            "sensors.front.type must be text, and is a number; known are: bumper, camera, hc-sr04, ld19$",
        ),
        (f"{POSE}[robot.sensors.other]\n{POSE}", r"sensors share an index: \[0, 0\]"),
    ],
)
def test_a_mistake_is_told_with_the_sensors_name(tmp_path: Path, entry: str, wrong: str) -> None:
    with pytest.raises(ConfigError, match=wrong) as refused:
        robot(tmp_path, f"[robot.sensors.front]\n{entry}\n")
    assert "front" in str(refused.value) or "share" in wrong


def test_a_part_of_the_robot_itself_is_not_below_the_floor(tmp_path: Path) -> None:
    sensor, low = f"[robot.sensors.front]\n{POSE}", "[robot.frames.arm]\nz = -0.1\n"
    assert robot(tmp_path, f"{sensor}{low}parent = 'range_front_link'\n").frames["arm"].z == -0.1
    with pytest.raises(ConfigError, match=r"z is -0.1 m: base_link is on the floor, so z must be 0 or more"):
        robot(tmp_path, f"{sensor}{low}")


def test_a_bumpers_name_is_one_that_a_key_can_have(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="a/b"):
        robot(tmp_path, "[robot.sensors.'a/b']\ntype = 'bumper'\nindex = 0\nway = 'forward'\n")


def test_what_a_sample_shows_is_drawn_in_the_robots_frame() -> None:
    sonar = Ultrasonic(index=0, x=0.25, y=0.1, yaw=0.0, half_cone=0.1, reach=2.0)
    heard = Range(sensor="a", state="echo", range=0.5, echo_us=2900, tick=None)
    assert sonar.evidence(heard, 0.3).seen[0][1] == pytest.approx((0.75, 0.1))
    assert sonar.summary(heard)[:2] == ("0.50 m", 0.5)
    clear = msgspec.structs.replace(heard, state="clear", range=None)
    assert max(x for x, _ in sonar.evidence(clear, 0.3).free[0]) == pytest.approx(2.25)
    assert (sonar.summary(clear)[:2], sonar.evidence(clear, 0.3)) == (("clear", None), (sonar.field(0.3), ()))
    fault = msgspec.structs.replace(clear, state="fault")
    assert (sonar.summary(fault).trouble.what, sonar.evidence(fault, 0.3)) == ("fault", ((), ()))
    bumper, pushed = Bumper(index=0, way="backward"), Bump(sensor="b", pressed=True, tick=None)
    assert bumper.summary(pushed).text == "pushed"
    assert bumper.evidence(pushed, 0.3).seen[0][4] == pytest.approx((-0.3, 0.0))


def a_scan(near: dict[int, int], **fields: Any) -> LaserScan:
    """Return a turn of a scanner that looks backward, clockwise. `near`: mm by number of the ray."""
    rays = array("H", [near.get(ray, 3000) for ray in range(RAYS)])
    told: dict[str, Any] = {"bearing": math.pi, "step": -math.tau / RAYS, "duration": 0.1, "since_tick": 0.0}
    return LaserScan(sensor="laser", ranges=packed(rays), tick=None, **told, **fields)


def test_a_scan_in_words_tells_the_nearest_in_each_quarter_and_what_is_blind() -> None:
    scan = a_scan({112: 800, 113: OWN | 140, 114: NOT_MEASURED, 225: 1500}, blind=(3, 4))  # 90 degrees on is the left
    assert LaserScanner.summary(scan) == (
        "ahead 1.50 m, left 0.80 m, behind 3.00 m, right 3.00 m, 2 of 36 sectors blind",
        0.8,
        Trouble(),
    )
    assert LaserScanner.summary(a_scan(dict.fromkeys(range(RAYS), 0))) == ("clear", None, Trouble())
    stuck = Trouble("laser: its motor is held")
    assert LaserScanner.summary(a_scan({}, trouble=stuck)) == ("fault", None, stuck)


def test_a_scan_is_drawn_by_lines_along_what_it_sees() -> None:
    mount = LaserScanner(x=-0.1, y=0.0, yaw=math.pi)
    gap = dict.fromkeys([*range(100, 130), *range(300, 330)], 0)
    strips = mount.evidence(a_scan({**gap, 225: 1500}), 0.3).seen
    assert [len(strip) for strip in strips] == [34, 32, 1, 24, 40]
    assert strips[2][0] == pytest.approx((1.4, 0.0))
    assert not mount.evidence(a_scan({}, trouble=Trouble("held")), 0.3).seen


@pytest.mark.parametrize("own", ["[[0.5, 0.1]]", "[[nan, 1.0]]", "[[0.0, 9.0]]"])
def test_arcs_that_the_robot_hides_have_two_ends_in_order(tmp_path: Path, own: str) -> None:
    with pytest.raises(ConfigError, match=r"sensors.laser.*own has the arc .* give radians, the smaller one first"):
        robot(tmp_path, f"[robot.sensors.laser]\ntype = 'ld19'\nx = 0.0\ny = 0.0\nyaw = 0.0\nown = {own}\n")
