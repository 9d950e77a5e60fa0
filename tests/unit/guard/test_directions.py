"""What the sensors say about each direction: how far, how sure, which one, why, and the way out."""

from __future__ import annotations

import math

import msgspec
import pytest

from giraff_guard.config import GuardConfig
from giraff_node.robot import SensorPose
from giraff_schemas.messages import Verdict
from tests.unit.guard.rig import CONFIG, EPOCH, FAR, FRONT, NEAR, ROBOT, Rig, robot_with

WAYS = [("forward", 0.6, FRONT), ("backward", -0.6, ("rear",))]
each_way = pytest.mark.parametrize(("way", "asked", "sensors"), WAYS, ids=["forward", "backward"])


def verdict(rig: Rig, way: str) -> Verdict:
    judged = getattr(rig.decide()[1], way)
    assert isinstance(judged, Verdict)
    return judged


def assert_blocked(rig: Rig, way: str, sensor: str, *reasons: str) -> None:
    """That `way` is closed, with all that an operator needs to know, and that nothing else is."""
    judged = verdict(rig, way)
    assert (judged.allowed, judged.freedom, judged.sensor) == (0.0, "blocked", sensor)
    for reason in (sensor, *reasons):
        assert reason in judged.reason
    assert judged.way_out == {"forward": "turn, or back up", "backward": "turn, or drive forward"}[way]
    asked = {"forward": 0.6, "backward": -0.6}[way]
    assert rig.passes(asked) == (0.0, 0.0)
    reason = rig.decide()[0].reason
    assert reason.startswith(f"{way} blocked: ")
    assert sensor in reason
    assert judged.way_out in reason
    assert rig.passes(0.0, 1.0) == (0.0, 1.0)
    assert rig.decide()[0].reason == ""


@each_way
def test_before_the_first_reading_a_way_is_blind(way: str, asked: float, sensors: tuple[str, ...]) -> None:
    assert_blocked(Rig(), way, sensors[0], "not been heard yet", "start giraff_ranger")
    assert asked


@each_way
def test_far_is_free(way: str, asked: float, sensors: tuple[str, ...]) -> None:
    rig = Rig()
    rig.hear(FAR)
    assert verdict(rig, way) == Verdict(allowed=0.6, freedom="free", sensor="", reason="", way_out="")
    assert rig.passes(asked, 0.5) == (asked, 0.5)
    assert rig.decide()[0].reason == ""
    assert sensors


@each_way
def test_clear_counts_for_the_sensors_reach(way: str, asked: float, sensors: tuple[str, ...]) -> None:
    rig = Rig()
    rig.hear(None)
    assert verdict(rig, way).freedom == "free"
    assert rig.passes(asked) == (asked, 0.0)
    rig = Rig(config=GuardConfig(reach=0.5))
    rig.hear(None)
    assert verdict(rig, way).freedom == "slow"
    assert verdict(rig, way).sensor in sensors


@each_way
def test_near_is_blocked(way: str, asked: float, sensors: tuple[str, ...]) -> None:
    for sensor in sensors:
        rig = Rig()
        rig.hear(FAR)
        rig.hear(NEAR, sensor)
        assert_blocked(rig, way, sensor, "0.30 m")
        assert rig.passes(-asked) == (-asked, 0.0)


@each_way
def test_a_faulty_sensor_blinds_its_way_only(way: str, asked: float, sensors: tuple[str, ...]) -> None:
    for sensor in sensors:
        rig = Rig()
        rig.hear(FAR)
        rig.hear(sensor=sensor, fault="the echo line stays high; check its wiring")
        assert_blocked(rig, way, sensor, "faulty", "check its wiring")
        assert rig.passes(-asked) == (-asked, 0.0)


@each_way
def test_a_stale_sensor_blinds_its_way_only(way: str, asked: float, sensors: tuple[str, ...]) -> None:
    for sensor in sensors:
        rig = Rig()
        rig.hear(FAR)
        rig.hear(FAR, sensor, age=0.4)
        assert verdict(rig, way).freedom != "blocked"
        rig.hear(FAR, sensor, age=0.4 + 1e-9)
        assert_blocked(rig, way, sensor, "stale", "0.4 s old", "check giraff_ranger")
        assert rig.passes(-asked) == (-asked, 0.0)


@each_way
@pytest.mark.parametrize("moment", ["other epoch", "ahead"])
def test_a_reading_that_proves_no_age_blinds(way: str, asked: float, sensors: tuple[str, ...], moment: str) -> None:
    rig = Rig()
    rig.hear(FAR)
    rig.hear(FAR, sensors[0], tick=rig.ago(0.05, EPOCH + 1) if moment == "other epoch" else rig.ago(-0.001))
    assert_blocked(rig, way, sensors[0], "stale", "of no known age")
    assert asked


def test_a_reading_gets_old_while_nothing_comes() -> None:
    rig = Rig()
    rig.hear(FAR, age=0.0)
    allowed = []
    for _ in range(50):
        rig.wait(0.01)
        allowed.append(verdict(rig, "forward").allowed)
    assert allowed[0] == 0.6
    assert allowed[39] > 0.0
    assert allowed[40:] == [0.0] * 10


@each_way
def test_a_sensor_that_the_robot_file_lacks_leaves_creep(way: str, asked: float, sensors: tuple[str, ...]) -> None:
    others = [name for name in ROBOT.sensors if name not in sensors]
    rig = Rig(robot_with(*others))
    rig.hear(FAR)
    judged = verdict(rig, way)
    assert (judged.allowed, judged.freedom, judged.sensor) == (0.1, "creep", "")
    assert way in judged.reason
    linear, angular = rig.passes(asked, 0.6)
    assert linear == pytest.approx(math.copysign(0.1, asked))
    assert angular == pytest.approx(0.1)
    assert f"{way} slowed: no sensor looks {way}" in rig.decide()[0].reason


@pytest.mark.parametrize("distance", [0.38, 0.42, 0.46, 0.5, 0.55])
def test_in_between_the_speed_is_what_stops_before_the_margin(distance: float) -> None:
    rig = Rig()
    rig.hear(distance, age=0.05)
    judged = verdict(rig, "forward")
    assert judged.freedom == "slow"
    assert judged.sensor in FRONT
    # A wall at 25°, seen by the edge of a cone of 7.5°; the disc of 0.3 m is what must not come nearer than 0.25 m.
    clearance = distance * math.cos(math.radians(17.5)) + 0.25 * math.cos(math.radians(25)) - 0.3
    stops_after = judged.allowed * 0.15 + judged.allowed**2 / 3.0
    assert stops_after == pytest.approx(clearance - 0.25)
    linear, angular = rig.passes(0.6, 0.3)
    assert linear == pytest.approx(judged.allowed)
    assert angular / linear == pytest.approx(0.5)
    assert f"{distance:.2f} m" in rig.decide()[0].reason


def test_an_older_reading_allows_less() -> None:
    allowed = []
    for age in (0.0, 0.1, 0.2, 0.4):
        rig = Rig()
        rig.hear(0.5, age=age)
        allowed.append(verdict(rig, "forward").allowed)
    assert allowed == sorted(allowed, reverse=True)
    assert len(set(allowed)) == 4


def test_the_nearest_of_two_sensors_limits() -> None:
    rig = Rig()
    rig.hear(0.5, "front_left")
    rig.hear(0.45, "front_right")
    assert verdict(rig, "forward").sensor == "front_right"


def test_less_than_the_slowest_speed_is_a_stop() -> None:
    allowed = set()
    for millimetres in range(300, 500):
        rig = Rig()
        rig.hear(millimetres / 1000)
        allowed.add(verdict(rig, "forward").allowed)
    assert min(allowed) == 0.0
    assert min(allowed - {0.0}) >= CONFIG.slowest
    assert min(allowed - {0.0}) < CONFIG.slowest + 0.02


def room_of(distance: float) -> float:
    clearance = distance * math.cos(math.radians(17.5)) + 0.25 * math.cos(math.radians(25)) - 0.3
    return clearance - CONFIG.margin


def test_a_blocked_way_opens_again_only_beyond_the_release() -> None:
    opens = next(d / 1000 for d in range(300, 900) if room_of(d / 1000) >= CONFIG.release)
    before = opens - 0.01
    rig = Rig()
    rig.hear(before)
    assert verdict(rig, "forward").freedom == "slow"
    rig.hear(NEAR)
    assert verdict(rig, "forward").freedom == "blocked"
    rig.hear(before)
    assert verdict(rig, "forward").freedom == "blocked"
    rig.hear(opens)
    assert verdict(rig, "forward").freedom == "slow"
    rig.hear(before)
    assert verdict(rig, "forward").freedom == "slow"


@pytest.mark.parametrize("blind", ["fault", "stale"])
def test_a_way_that_was_blind_opens_only_beyond_the_release_too(blind: str) -> None:
    before = next(d / 1000 for d in range(300, 900) if room_of(d / 1000) >= CONFIG.release) - 0.01
    rig = Rig()
    if blind == "fault":
        rig.hear(fault="broken")
    else:
        rig.hear(FAR, age=1.0)
    assert verdict(rig, "forward").freedom == "blocked"
    rig.hear(before)
    assert verdict(rig, "forward").freedom == "blocked"
    rig.hear(FAR)
    assert verdict(rig, "forward").freedom == "free"


@each_way
def test_a_robot_faster_than_it_may_be_brakes(way: str, asked: float, sensors: tuple[str, ...]) -> None:
    rig = Rig()
    rig.hear(0.5)
    rig.move(asked)
    assert_blocked(rig, way, sensors[0], "braking")
    rig.move(asked / 10)
    rig.wait(0.06)  # the speed of before counts as far back as the reading lies
    rig.hear(0.5)
    assert verdict(rig, way).freedom == "slow"
    rig.move(-asked)
    assert verdict(rig, way).freedom == "slow"


def test_speed_since_the_reading_counts_though_the_robot_is_slower_now() -> None:
    rig = Rig()
    rig.hear(0.5, age=0.0)
    rig.move(0.6)
    rig.decide()
    rig.wait(0.2)
    rig.move(0.1)
    fast = verdict(rig, "forward").allowed
    slow = Rig()
    slow.hear(0.5, age=0.0)
    slow.move(0.1)
    slow.decide()
    slow.wait(0.2)
    slow.move(0.1)
    assert fast < verdict(slow, "forward").allowed


def test_turning_is_not_driving() -> None:
    rig = Rig()
    rig.hear(0.5)
    rig.move(0.0, turning=0.6)
    assert verdict(rig, "forward").freedom == "slow"


def test_wheels_that_are_not_heard_are_no_speed() -> None:
    rig = Rig()
    rig.hear(0.5)
    rig.move(0.6, age=0.41)
    assert verdict(rig, "forward").freedom == "slow"


@pytest.mark.parametrize(
    ("pose", "ways"),
    [
        (SensorPose(index=0, x=0.25, y=0.0, yaw=0.0), {"forward"}),
        (SensorPose(index=0, x=0.25, y=0.0, yaw=0.7), {"forward"}),
        (SensorPose(index=0, x=0.25, y=0.0, yaw=-0.7), {"forward"}),
        (SensorPose(index=0, x=-0.25, y=0.0, yaw=math.pi), {"backward"}),
        (SensorPose(index=0, x=-0.25, y=0.0, yaw=-math.pi + 0.5), {"backward"}),
        (SensorPose(index=0, x=0.0, y=0.2, yaw=math.pi / 2), set()),
        (SensorPose(index=0, x=0.25, y=0.0, yaw=0.85), set()),
    ],
)
def test_a_sensor_speaks_for_the_way_it_looks(pose: SensorPose, ways: set[str]) -> None:
    rig = Rig(msgspec.structs.replace(ROBOT, sensors={"only": pose}))
    assert {way for way in ("forward", "backward") if verdict(rig, way).freedom == "blocked"} == ways


@pytest.mark.parametrize(
    ("x", "yaw", "offset"),
    [(0.25, 0.0, 0.25), (-0.25, math.pi, 0.25), (-0.1, 0.0, -0.1), (0.1, math.pi, -0.1), (0.0, 0.0, 0.0)],
)
def test_distance_counts_from_where_the_sensor_sits(x: float, yaw: float, offset: float) -> None:
    head_on = GuardConfig(incidence=1e-9, half_cone=1e-9)
    rig = Rig(msgspec.structs.replace(ROBOT, sensors={"only": SensorPose(index=0, x=x, y=0.0, yaw=yaw)}), head_on)
    rig.hear(0.7 - offset, age=0.0)
    # The obstacle is 0.7 m from base_link each time: 0.4 m from the footprint, 0.15 m beyond the margin.
    allowed = verdict(rig, "forward" if yaw == 0.0 else "backward").allowed
    assert allowed * 0.1 + allowed**2 / 3.0 == pytest.approx(0.15)


@pytest.mark.parametrize("field", GuardConfig.__struct_fields__)
@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf])
def test_a_number_that_makes_no_sense_is_refused_by_name(field: str, value: float) -> None:
    with pytest.raises(ValueError, match=field):
        GuardConfig(**{field: value})
