"""What the sensors allow in each direction: how fast, which one limits, why, and the way out."""

import math

import msgspec
import pytest

from giraff_core.senses import Ultrasonic
from giraff_guard.config import GuardConfig
from giraff_schemas.messages import DirectionLimit
from giraff_schemas.trouble import NO_TROUBLE
from tests.unit.guard.senses import CONFIG, CYCLE, EPOCH, FAR, FRONT, NEAR, ROBOT, Senses, opened, robot_with

WAYS = [("forward", 0.6, FRONT), ("backward", -0.6, ("rear",))]
each_way = pytest.mark.parametrize(("way", "asked", "sensors"), WAYS, ids=["forward", "backward"])
HEAD_ON = msgspec.structs.replace(CONFIG, incidence=0.001, half_cone=0.001)


def assert_blocked(senses: Senses, way: str, sensor: str, *reasons: str) -> None:
    """That `way` is closed, with all that an operator needs to know, and that nothing else is."""
    judged = senses.verdict(way)
    assert (judged.allowed, judged.clearance, judged.sensor) == (0.0, "blocked", sensor)
    for reason in (sensor, *reasons):
        assert reason in str(judged.reason)
    asked = {"forward": 0.6, "backward": -0.6}[way]
    assert senses.passes(asked) == (0.0, 0.0)
    limited = senses.limit(asked, 0.0)
    assert str(limited.reason) == f"{way} blocked: {judged.reason}"
    assert senses.passes(0.0, 1.0) == (0.0, 1.0)
    assert senses.limit(0.0, 1.0).reason == NO_TROUBLE


@each_way
def test_before_the_first_reading_a_way_is_blind(way: str, asked: float, sensors: tuple[str, ...]) -> None:
    assert_blocked(Senses(), way, sensors[0], "not been heard yet", "start giraff_ranger")
    assert asked


@each_way
def test_one_reading_opens_nothing_and_two_do(way: str, asked: float, sensors: tuple[str, ...]) -> None:
    senses = Senses()
    senses.hear(FAR)
    assert_blocked(senses, way, sensors[0], "only once")
    senses.wait(CYCLE)
    senses.hear(FAR)
    assert senses.passes(asked)[0] == pytest.approx(math.copysign(0.1, asked))


@each_way
def test_far_is_free(senses: Senses, way: str, asked: float, sensors: tuple[str, ...]) -> None:
    assert senses.verdict(way) == DirectionLimit(allowed=0.6, clearance="free", sensor="")
    assert senses.passes(asked, 0.5) == (asked, 0.5)
    assert senses.limit(asked, 0.5).reason == NO_TROUBLE
    assert senses.troubles() == dict.fromkeys(ROBOT.sensors, NO_TROUBLE)
    assert sensors


@each_way
def test_near_is_blocked_at_the_first_reading(way: str, asked: float, sensors: tuple[str, ...]) -> None:
    for sensor in sensors:
        senses = opened()
        senses.hear(NEAR, sensor)
        assert_blocked(senses, way, sensor, "0.30 m")
        assert senses.passes(-asked) == (-asked, 0.0)


@pytest.mark.parametrize(
    ("near", "remedy"),
    [
        ({"front_left": 0.3}, "turn right or back up"),
        ({"front_right": 0.3}, "turn left or back up"),
        ({"front_left": 0.3, "front_right": 0.35}, "turn or back up"),
        ({"front_left": 0.3, "rear": 0.3}, "turn right"),
    ],
)
def test_the_way_out_is_where_there_is_room(senses: Senses, near: dict[str, float], remedy: str) -> None:
    for sensor, distance in near.items():
        senses.hear(distance, sensor)
    assert senses.verdict().reason.remedy == remedy


def test_the_way_out_of_a_blocked_rear_is_forward(senses: Senses) -> None:
    senses.hear(NEAR, "rear")
    assert senses.verdict("backward").reason.remedy == "turn or drive forward"


@each_way
def test_a_faulty_sensor_blinds_its_way_only(way: str, asked: float, sensors: tuple[str, ...]) -> None:
    for sensor in sensors:
        senses = opened()
        senses.hear(None, sensor, fault="the echo line stays high; check its wiring")
        assert_blocked(senses, way, sensor, "faulty", "check its wiring")
        assert "check its wiring" in str(senses.troubles()[sensor])
        assert senses.passes(-asked) == (-asked, 0.0)


@each_way
def test_a_sensor_that_flickers_opens_nothing(senses: Senses, way: str, asked: float, sensors: tuple[str, ...]) -> None:
    for _ in range(20):
        senses.wait(CYCLE / 2)
        senses.hear(None, sensors[0], fault="broken")
        assert senses.passes(asked) == (0.0, 0.0)
        senses.wait(CYCLE / 2)
        senses.hear(FAR)
        assert senses.passes(asked) == (0.0, 0.0)
        assert senses.verdict(way).clearance == "blocked"


@each_way
def test_a_stale_sensor_blinds_its_way_only(way: str, asked: float, sensors: tuple[str, ...]) -> None:
    for sensor in sensors:
        senses = opened()
        senses.robot_ns += 400_000_000
        senses.report()
        senses.hear(FAR, *(name for name in ROBOT.sensors if name != sensor))
        assert senses.verdict(way).clearance != "blocked"
        senses.robot_ns += 1
        assert_blocked(senses, way, sensor, "stale", "0.4 s old", "check giraff_ranger")
        assert "stale" in str(senses.troubles()[sensor])
        assert senses.passes(-asked)[0] == -asked


@each_way
def test_a_sensor_of_half_a_second_opens_nothing(way: str, asked: float, sensors: tuple[str, ...]) -> None:
    """A clone of the HC-SR04 that waits 180 ms for an echo in the open: a reading each 0.54 s."""
    senses = opened()
    senses.wait(0.54)
    for _ in range(10):
        senses.hear(None)
        assert senses.passes(asked) == (0.0, 0.0)
        senses.wait(0.54)
        assert senses.passes(asked) == (0.0, 0.0)
    assert senses.verdict(way).sensor in sensors


@each_way
@pytest.mark.parametrize("moment", ["other epoch", "ahead", "none"])
def test_a_reading_that_proves_no_age_blinds(way: str, asked: float, sensors: tuple[str, ...], moment: str) -> None:
    senses = opened()
    tick = senses.ago(0.05, EPOCH + 1) if moment == "other epoch" else senses.ago(-0.001)
    senses.hear(FAR, sensors[0], tick=tick)
    assert_blocked(senses, way, sensors[0], "stale", "of no known age")
    assert asked


def test_a_reading_gets_old_while_nothing_comes(senses: Senses) -> None:
    allowed = []
    for _ in range(25):
        senses.wait(0.02)
        allowed.append(senses.allowed())
    assert allowed[0] == 0.6
    assert allowed[19] > 0.0
    assert allowed[20:] == [0.0] * 5


@each_way
def test_a_sensor_that_the_robot_file_lacks_leaves_creep(way: str, asked: float, sensors: tuple[str, ...]) -> None:
    senses = opened(robot_with(*(name for name in ROBOT.sensors if name not in sensors)))
    judged = senses.verdict(way)
    assert (judged.allowed, judged.clearance, judged.sensor) == (0.1, "creep", "")
    assert way in str(judged.reason)
    linear, angular = senses.passes(asked, 0.6)
    assert linear == pytest.approx(math.copysign(0.1, asked))
    assert angular == pytest.approx(0.1)
    limited = senses.limit(asked, 0.6)
    assert f"{way} slowed: no sensor looks {way}" in str(limited.reason)
    assert limited.range_tick is None


def test_a_reading_of_a_sensor_that_the_robot_file_lacks_is_nobodys(senses: Senses) -> None:
    senses.hear(NEAR, "mast")
    assert senses.verdict().clearance == "free"


@pytest.mark.parametrize("distance", [0.42, 0.46, 0.5, 0.55])
def test_in_between_the_speed_is_what_stops_before_the_margin(senses: Senses, distance: float) -> None:
    senses.hear(distance, age=0.05)
    senses.hear(distance, age=0.05)
    judged = senses.verdict()
    assert judged.clearance in ("slow", "creep")
    assert judged.sensor in FRONT
    # A wall at 25°, seen by the edge of a cone of 7.5°; the disc of 0.3 m is what must not come nearer than 0.25 m.
    clearance = distance * math.cos(math.radians(17.5)) + 0.25 * math.cos(math.radians(25)) - 0.3
    stops_after = judged.allowed * 0.15 + judged.allowed**2 / 3.0
    assert stops_after == pytest.approx(clearance - 0.25)
    linear, angular = senses.passes(0.6, 0.3)
    assert linear == pytest.approx(judged.allowed)
    assert angular / linear == pytest.approx(0.5)
    assert f"{distance:.2f} m" in str(senses.limit(0.6, 0.3).reason)


def test_without_a_measured_deceleration_the_robot_creeps() -> None:
    senses = opened(config=GuardConfig())
    for way in ("forward", "backward"):
        judged = senses.verdict(way)
        assert (judged.allowed, judged.clearance) == (0.1, "creep")
        assert "deceleration has not been measured" in str(judged.reason)
    assert senses.passes(0.6)[0] == pytest.approx(0.1)
    senses.hear(NEAR)
    assert senses.allowed() == 0.0


def test_an_older_reading_allows_less() -> None:
    allowed = []
    for age in (0.0, 0.1, 0.2, 0.4):
        senses = opened()
        senses.robot_ns += 400_000_000
        senses.report()
        senses.hear(0.5, age=age)
        allowed.append(senses.allowed())
    assert allowed == sorted(allowed, reverse=True)
    assert len(set(allowed)) == 4


def test_the_nearest_of_two_sensors_limits(senses: Senses) -> None:
    senses.hear(0.5, "front_left")
    senses.hear(0.45, "front_right")
    assert senses.verdict().sensor == "front_right"


def test_less_than_the_slowest_speed_is_a_stop() -> None:
    allowed = set()
    for millimetres in range(336, 348):
        senses = opened()
        senses.hear(millimetres / 1000)
        allowed.add(senses.allowed())
    assert min(allowed) == 0.0
    assert min(allowed - {0.0}) >= CONFIG.min_speed
    assert min(allowed - {0.0}) < CONFIG.min_speed + 0.02


def room_of(distance: float) -> float:
    clearance = distance * math.cos(math.radians(17.5)) + 0.25 * math.cos(math.radians(25)) - 0.3
    return clearance - CONFIG.margin


def test_a_blocked_way_opens_again_only_beyond_the_release() -> None:
    opens = next(d / 1000 for d in range(300, 900) if room_of(d / 1000) >= CONFIG.release)
    before = opens - 0.01
    senses = opened()
    senses.cycle(before, cycles=3)
    assert senses.verdict().clearance in ("slow", "creep")
    senses.cycle(NEAR, cycles=2)
    senses.cycle(before, cycles=4)
    assert senses.verdict().clearance == "blocked"
    senses.cycle(opens, cycles=3)
    assert senses.allowed() > 0.0
    senses.cycle(before)
    assert senses.allowed() > 0.0


@each_way
def test_a_robot_faster_than_it_may_be_brakes(senses: Senses, way: str, asked: float, sensors: tuple[str, ...]) -> None:
    senses.hear(0.5)
    senses.linear = asked
    senses.report()
    assert_blocked(senses, way, sensors[-1] if way == "backward" else "front_left", "braking")
    senses.linear = asked / 10
    senses.report()
    assert senses.allowed(way) > 0.0
    senses.linear = -asked
    senses.report()
    assert senses.allowed(way) > 0.0


def test_what_was_commanded_counts_where_it_is_more_than_the_wheels_say(senses: Senses) -> None:
    senses.asked = (0.6, 0.0)
    senses.wait(0.2)
    senses.hear(0.5)
    assert "braking" in str(senses.verdict().reason)


def test_the_way_since_the_reading_counts(senses: Senses) -> None:
    """At rest again after 0.12 m; the reading is the one from before."""
    senses.cycle(0.5, cycles=4)
    assert senses.allowed() > 0.2
    senses.linear = 0.5
    senses.wait(0.24)
    senses.linear = 0.0
    senses.report()
    assert room_of(0.5) - 0.12 < CONFIG.release
    assert senses.allowed() == 0.0
    assert "0.50 m" in str(senses.verdict().reason)


@pytest.mark.parametrize(("way", "sign", "sensors"), [("forward", 1.0, FRONT), ("backward", -1.0, ("rear",))])
def test_a_reading_counts_from_where_the_robot_was_when_it_was_taken(
    way: str, sign: float, sensors: tuple[str, ...]
) -> None:
    """It came late: the robot has driven 0.12 m since."""
    allowed = []
    for driven in (0.0, 0.12):
        senses = opened()
        senses.linear = sign * driven / 0.24
        senses.wait(0.24)
        senses.linear = 0.0
        senses.report()
        senses.hear(0.5, *sensors, age=0.24)
        allowed.append(senses.allowed(way))
    assert allowed[0] > 0.3
    assert allowed[1] < 0.25


def test_turning_is_not_driving(senses: Senses) -> None:
    senses.angular = 1.5
    senses.report()
    senses.hear(0.5)
    assert senses.allowed() > 0.0


@pytest.mark.parametrize(
    ("pose", "ways"),
    [
        (Ultrasonic(index=0, x=0.25, y=0.0, yaw=0.0), {"forward"}),
        (Ultrasonic(index=0, x=0.25, y=0.0, yaw=0.7), {"forward"}),
        (Ultrasonic(index=0, x=0.25, y=0.0, yaw=-0.7), {"forward"}),
        (Ultrasonic(index=0, x=-0.25, y=0.0, yaw=math.pi), {"backward"}),
        (Ultrasonic(index=0, x=-0.25, y=0.0, yaw=-math.pi + 0.5), {"backward"}),
        (Ultrasonic(index=0, x=0.0, y=0.2, yaw=math.pi / 2), set()),
        (Ultrasonic(index=0, x=0.25, y=0.0, yaw=0.85), set()),
    ],
)
def test_a_sensor_speaks_for_the_way_it_looks(pose: Ultrasonic, ways: set[str]) -> None:
    senses = Senses(msgspec.structs.replace(ROBOT, sensors={"only": pose}))
    assert {way for way in ("forward", "backward") if senses.verdict(way).clearance == "blocked"} == ways


def stopping_room(senses: Senses, way: str = "forward") -> float:
    """m that what is allowed now takes to a stop."""
    allowed = senses.allowed(way)
    return allowed * 0.1 + allowed**2 / 3.0


@pytest.mark.parametrize(
    ("x", "yaw", "offset"),
    [(0.25, 0.0, 0.25), (-0.25, math.pi, 0.25), (-0.1, 0.0, -0.1), (0.1, math.pi, -0.1), (0.0, 0.0, 0.0)],
)
def test_distance_counts_from_where_the_sensor_sits(x: float, yaw: float, offset: float) -> None:
    only = {"only": Ultrasonic(index=0, x=x, y=0.0, yaw=yaw)}
    senses = opened(msgspec.structs.replace(ROBOT, sensors=only), HEAD_ON)
    senses.hear(0.7 - offset)
    # The obstacle is 0.7 m from base_link each time: 0.4 m from the footprint, 0.15 m beyond the margin.
    assert stopping_room(senses, "forward" if yaw == 0.0 else "backward") == pytest.approx(0.15)


@pytest.mark.parametrize("yaw", [0.0, 0.5, -0.5, math.pi, math.pi - 0.5, 0.5 - math.pi])
@pytest.mark.parametrize(("x", "y"), [(0.2, 0.15), (0.2, -0.15), (-0.2, 0.1)])
def test_a_sensor_that_looks_askew_counts_from_where_it_sits(x: float, y: float, yaw: float) -> None:
    """A wall at 25 degrees to either side, whose echo came from the near edge of the cone."""
    if (x * math.cos(yaw) + y * math.sin(yaw)) < 0.0:
        x, y = -x, -y
    senses = opened(msgspec.structs.replace(ROBOT, sensors={"only": Ultrasonic(index=0, x=x, y=y, yaw=yaw)}))
    senses.hear(0.6)
    normals = (yaw + math.radians(25.0), yaw - math.radians(25.0))
    walls = [x * math.cos(normal) + y * math.sin(normal) + 0.6 * math.cos(math.radians(17.5)) for normal in normals]
    way = "forward" if abs(yaw) < 1.0 else "backward"
    expected = min(0.18, min(walls) - ROBOT.footprint_radius - CONFIG.margin)  # full speed takes 0.18 m
    assert stopping_room(senses, way) == pytest.approx(expected)


@each_way
@pytest.mark.parametrize("radius", [0.15, 0.2, 0.45])
def test_distance_counts_to_the_footprint_of_this_robot(
    way: str, asked: float, sensors: tuple[str, ...], radius: float
) -> None:
    senses = opened(msgspec.structs.replace(ROBOT, footprint_radius=radius), HEAD_ON)
    senses.hear(radius + 0.15)
    # The sensors sit 0.25 m ahead: 0.4 m from the footprint, 0.15 m beyond the margin.
    assert stopping_room(senses, way) == pytest.approx(0.15)
    assert asked
    assert sensors


@pytest.mark.parametrize(
    ("offsets", "charged"),
    [((0.15,), True), ((-0.15,), True), ((0.0,), False), ((0.15, -0.15), False), ((0.15, 0.1), True)],
)
def test_a_sensor_aside_is_charged_for_the_side_where_no_other_looks(offsets: tuple[float, ...], charged: bool) -> None:
    sensors = {f"s{i}": Ultrasonic(index=i, x=0.25, y=y, yaw=0.0) for i, y in enumerate(offsets)}
    senses = opened(msgspec.structs.replace(ROBOT, sensors=sensors))
    senses.hear(0.5)
    least = 0.5 * math.cos(math.radians(17.5)) + 0.25 * math.cos(math.radians(25)) - 0.3 - 0.25
    aside = min(map(abs, offsets)) * math.sin(math.radians(25)) if charged else 0.0
    assert stopping_room(senses) == pytest.approx(least - aside)
