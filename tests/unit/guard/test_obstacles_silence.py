"""A sensor that hears nothing may have gone deaf: how long its silence is believed, and what it heard before it."""

import math

import msgspec
import pytest

from giraff_core.kinematics.pose import Pose
from giraff_core.senses import HC_SR04
from giraff_guard.config import GuardConfig
from giraff_guard.judge.recent import RecentObstacles
from giraff_guard.limits import DriveDirection
from giraff_guard.stopping import stopping_distance
from tests.support.robots import ULTRASONIC
from tests.unit.guard.senses import CONFIG, CYCLE, FAR, FRONT, NEAR, ROBOT, SIDES, Senses, beam, limits, opened

FULL = ROBOT.max_wheel_speed
SLOW = CONFIG.untrusted_speed
WALL = 1.5  # m before the sensors


def unproven() -> Senses:
    """Proven far from anything, then hearing nothing until that is worth nothing."""
    senses = opened()
    senses.cycle(None, cycles=round(21.0 / CYCLE))
    return senses


def faded(share: float) -> float:
    return FULL - share * (FULL - SLOW)


def fades(expected: dict[float, float], off: float, linear: float = 0.0, angular: float = 0.0) -> None:
    """Require these shares after so many s of silence, the robot moving at this."""
    senses, cycles = opened(), 0
    for seconds, share in expected.items():
        senses.linear, senses.angular = linear, angular
        senses.cycle(None, cycles=round(seconds / CYCLE) - cycles)
        senses.linear = senses.angular = 0.0
        assert senses.allowed() == pytest.approx(faded(share), abs=off), seconds
        cycles = round(seconds / CYCLE)


def test_silence_is_worth_less_after_ten_seconds() -> None:
    fades({1.0: 0.0, 9.5: 0.0, 12.5: 0.25, 17.5: 0.75, 20.5: 1.0, 25.0: 1.0}, 0.01)


@pytest.mark.parametrize("speed", [0.3, -0.3])
def test_silence_is_worth_less_after_so_much_way(speed: float) -> None:
    shares = {1.1: 0.0, 1.4: 0.25, 1.8: 0.75, 2.1: 1.0, 2.8: 1.0}
    fades({way / abs(speed): share for way, share in shares.items()}, 0.03, speed)


@pytest.mark.parametrize("speed", [1.0, -1.0])
def test_a_turn_counts_as_way(speed: float) -> None:
    fades({2.2: 0.0, 3.2: 0.5, 4.4: 1.0}, 0.06, 0.0, speed)


def test_turning_there_and_back_counts_twice(senses: Senses) -> None:
    for speed in (1.0, -1.0):
        senses.angular = speed
        senses.cycle(None, cycles=12)
    assert senses.allowed() == pytest.approx(SLOW)


def test_where_the_wheels_are_not_heard_what_was_passed_on_counts(senses: Senses) -> None:
    senses.asked = (0.1, 0.0)
    for _ in range(50):
        senses.wait(CYCLE, wheels=False)
        senses.hear(None)
    assert senses.obstacles._motion.travel > 0.5
    senses.asked = (0.0, 0.5)
    for _ in range(40):
        senses.wait(CYCLE, wheels=False)
        senses.hear(None)
    assert senses.obstacles._motion.turned > 3.0


@pytest.mark.parametrize("sensor", FRONT)
def test_each_sensor_of_a_way_has_to_prove_itself(senses: Senses, sensor: str) -> None:
    senses.cycle({sensor: None}, cycles=round(21.0 / CYCLE))
    judged = senses.verdict()
    assert judged.sensor == sensor
    assert judged.allowed == pytest.approx(SLOW)
    assert "has not proved lately that it hears" in judged.reason.what
    assert senses.troubles()[sensor] == judged.reason
    assert senses.verdict("backward").clearance == "free"


@pytest.mark.parametrize("between", [0, 1, 2])
def test_an_echo_that_follows_from_one_just_before_proves_it(between: int) -> None:
    """Those between may be lost: a slanted wall answers now and then."""
    senses = unproven()
    senses.cycle(FAR)
    senses.cycle(None, cycles=between)
    assert senses.allowed() < 0.2
    senses.cycle(FAR)
    senses.cycle(None, cycles=6)
    assert senses.verdict().clearance == "free"


def test_one_echo_proves_nothing() -> None:
    senses = unproven()
    for distance in (FAR, None, None, None, FAR, None, None, None, FAR):
        senses.cycle(distance)
    assert senses.allowed() == pytest.approx(SLOW)


def heard(distance: float = NEAR, way: str = "forward", config: GuardConfig = CONFIG) -> Senses:
    """At rest before something that both readings of this way's sensors have shown, twice; then they are silent."""
    senses = opened(config=config)
    senses.cycle(dict.fromkeys(SIDES[way], distance), cycles=3)
    senses.cycle(dict.fromkeys(SIDES[way], None), cycles=2)
    return senses


@pytest.mark.parametrize("way", ["forward", "backward"])
def test_what_fell_silent_blocks_for_a_moment_and_then_slows(way: str) -> None:
    senses = heard(way=way)
    judged = senses.verdict(way)
    assert judged.clearance == "blocked"
    assert judged.reason.remedy
    assert f"silent where {judged.sensor} heard something until lately" in judged.reason.what
    for _ in range(round((CONFIG.silent_time - 2.0) / CYCLE)):
        senses.cycle(dict.fromkeys(SIDES[way], None))
        assert senses.allowed(way) <= SLOW
    assert senses.allowed(way) == pytest.approx(SLOW)
    other = "backward" if way == "forward" else "forward"
    assert senses.verdict(other).clearance == "free"


def test_it_ends_after_its_time() -> None:
    config = msgspec.structs.replace(CONFIG, silent_time=5.0)
    senses = heard(config=config)
    senses.cycle(None, cycles=round(4.0 / CYCLE))
    assert senses.allowed() == pytest.approx(SLOW)
    senses.cycle(None, cycles=round(2.0 / CYCLE))
    assert senses.verdict().clearance == "free"


def test_the_speed_towards_it_is_what_stops_before_the_margin() -> None:
    senses = heard(0.5, config=msgspec.structs.replace(CONFIG, silent_beside=0.2))
    senses.cycle(dict.fromkeys(FRONT, None), cycles=5)
    allowed = senses.allowed()
    reach = ROBOT.footprint_radius + CONFIG.silent_radius
    edge = HC_SR04.half_cone  # of the cone: where a slanted wall answers from, and nearer to the middle
    way = 0.25 + 0.5 * math.cos(edge) - math.sqrt(reach**2 - (0.15 - 0.5 * math.sin(edge)) ** 2)
    assert stopping_distance(allowed, 0.1, 1.5) == pytest.approx(way - CONFIG.margin, abs=0.001)
    assert SLOW < allowed < FULL


def test_the_robot_that_is_too_fast_for_it_brakes() -> None:
    senses = opened(config=msgspec.structs.replace(CONFIG, memory_range=0.1, silent_block=0.05))
    senses.linear = 0.5
    distance = WALL
    for _ in range(10):
        senses.cycle(dict.fromkeys(FRONT, distance))
        distance -= 0.5 * CYCLE
    senses.cycle(dict.fromkeys(FRONT, None), cycles=3)
    assert senses.verdict().clearance == "blocked"
    senses.linear = SLOW
    senses.cycle(dict.fromkeys(FRONT, None), cycles=6)
    assert senses.allowed() == pytest.approx(SLOW)


@pytest.mark.parametrize("distance", [CONFIG.silent_range - 0.05, CONFIG.silent_range + 0.05])
def test_what_is_so_far_away_is_left_to_the_fading_trust(distance: float) -> None:
    """What is farther is reached after the way in which the trust has gone."""
    senses = opened(distance=distance)
    senses.linear = 0.25
    senses.cycle(None, cycles=round(1.9 / 0.25 / CYCLE))
    assert ("heard something until lately" in str(senses.verdict().reason)) is (distance < CONFIG.silent_range)
    sensor = ULTRASONIC["front_left"]
    assert CONFIG.silent_range + sensor.x - ROBOT.footprint_radius > CONFIG.trust_end_travel


def test_while_every_sensor_of_its_way_hears_something_it_does_not_count() -> None:
    senses = heard()
    senses.cycle(FAR, cycles=10)
    assert senses.verdict().clearance == "free"


def test_one_silent_sensor_is_enough_whoever_heard_it(senses: Senses) -> None:
    senses.cycle({"front_left": NEAR}, cycles=3)
    senses.cycle({"front_right": None}, cycles=8)
    judged = senses.verdict()
    assert judged.allowed == pytest.approx(SLOW)
    assert judged.sensor == "front_right"
    assert judged.reason.what.startswith("front_right: silent ")
    assert "front_left heard" in judged.reason.what


def test_a_farther_echo_does_not_end_it() -> None:
    senses = heard()
    senses.cycle(FAR, cycles=4)
    senses.cycle(None, cycles=2)
    assert senses.allowed() <= SLOW


def test_one_lost_reading_is_no_silence() -> None:
    senses = opened(distance=0.5)
    fast = senses.allowed()
    senses.cycle(dict.fromkeys(FRONT, None))
    assert senses.allowed() == fast


def flickering(lost: int = 1) -> Senses:
    """Something near that the front sensors heard now and then, and do not hear now."""
    senses = opened()
    senses.cycle(None, cycles=4)
    for _ in range(3):
        senses.cycle(dict.fromkeys(FRONT, NEAR))
        senses.cycle(dict.fromkeys(FRONT, None), cycles=lost)
    return senses


@pytest.mark.parametrize("lost", [1, 2])
def test_what_a_sensor_that_flickers_has_heard_is_held_as_well(lost: int) -> None:
    senses = flickering(lost)
    senses.cycle(dict.fromkeys(FRONT, None), cycles=8)
    assert senses.allowed() == pytest.approx(SLOW)
    assert "until lately" in str(senses.verdict().reason)


def test_one_echo_is_not_held(senses: Senses) -> None:
    senses.cycle(None, cycles=2)
    senses.cycle(dict.fromkeys(FRONT, NEAR))
    senses.cycle(None, cycles=8)
    assert senses.allowed() > SLOW


EDGE_X, EDGE_Y = math.cos(HC_SR04.half_cone), math.sin(HC_SR04.half_cone)
"""m: either edge of the cone of what was heard 1 m away."""
BESIDE = ROBOT.footprint_radius + CONFIG.silent_beside


def place_after(x: float, y: float, yaw: float) -> Pose:
    return Pose(0.0, 0.0, 0.0)._replace(x=x, y=y, yaw=yaw)


def spot(x: float = 1.0, y: float = 0.0, *, is_sure: bool = True, way: DriveDirection = "forward") -> RecentObstacles:
    """One thing that was heard, there."""
    held = RecentObstacles(way, limits())
    held.on_beam(beam("one", x, Pose(0.0, y, 0.0), is_sure=is_sure))
    return held


@pytest.mark.parametrize(
    ("place", "way", "distance"),
    [
        ((0.0, 0.0, 0.0), "forward", 0.6),
        ((0.0, 0.0, 0.0), "backward", None),
        ((0.0, 0.0, math.pi), "backward", 0.6),
        ((0.5, 0.0, 0.0), "forward", 0.1),
        ((0.7, 0.0, 0.0), "forward", 0.0),
        ((1.5, 0.0, 0.0), "forward", None),
        ((0.0, EDGE_Y + 0.39, 0.0), "forward", EDGE_X - math.sqrt(0.4**2 - 0.39**2)),
        ((0.0, -EDGE_Y - 0.39, 0.0), "forward", EDGE_X - math.sqrt(0.4**2 - 0.39**2)),
        ((0.0, EDGE_Y + 0.41, 0.0), "forward", None),
        ((0.0, 0.0, 0.6), "forward", None),
    ],
)
def test_what_lies_ahead_is_met_by_the_footprint(
    place: tuple[float, float, float], way: DriveDirection, distance: float | None
) -> None:
    found = spot(way=way).ahead(place_after(*place))
    assert (None if found is None else found.distance) == (None if distance is None else pytest.approx(distance))
    assert found is None or found.sensor == "one"


@pytest.mark.parametrize(
    ("place", "way", "distance"),
    [
        ((0.0, 0.45, 0.0), "forward", EDGE_X - math.sqrt(BESIDE**2 - (0.45 - EDGE_Y) ** 2)),
        ((0.0, EDGE_Y + BESIDE + 0.01, 0.0), "forward", None),
        ((1.0, EDGE_Y + BESIDE - 0.01, 0.0), "forward", 0.0),
        ((1.0, EDGE_Y + BESIDE + 0.01, 0.0), "forward", None),
        ((1.0, -EDGE_Y - BESIDE + 0.01, 0.0), "forward", 0.0),
        ((1.25, 0.45, 0.0), "forward", 0.0),
        ((1.35, 0.45, 0.0), "forward", None),
        ((1.35, 0.45, 0.0), "backward", 0.0),
        ((0.65, 0.45, 0.0), "backward", None),
    ],
)
def test_a_wall_goes_on_beside_where_it_was_heard(
    place: tuple[float, float, float], way: DriveDirection, distance: float | None
) -> None:
    found = spot(way=way).beside(place_after(*place))
    assert (None if found is None else found.distance) == (None if distance is None else pytest.approx(distance))
    assert found is None or found.sensor == "one"


def test_what_it_comes_to_beside_slows_it_in_time() -> None:
    config = msgspec.structs.replace(CONFIG, deceleration=0.2)
    senses = heard(0.6, config=config)
    senses.angular = 1.0 / (6.0 * CYCLE)
    senses.cycle(dict.fromkeys(FRONT, None), cycles=6)
    senses.angular = 0.0
    x, y = 0.25 + 0.6 * EDGE_X, 0.15 + 0.6 * EDGE_Y
    x, y = x * math.cos(1.0) + y * math.sin(1.0), y * math.cos(1.0) - x * math.sin(1.0)
    reach = ROBOT.footprint_radius + config.silent_beside
    allowed = senses.allowed()
    assert stopping_distance(allowed, 0.1, 0.2) == pytest.approx(x - math.sqrt(reach**2 - y**2), abs=0.02)
    assert SLOW < allowed < FULL
    assert "silent beside where" in str(senses.verdict().reason)


def test_along_a_wall_that_was_heard_the_robot_is_slow() -> None:
    senses = heard()
    senses.angular = -1.0
    senses.cycle(None, cycles=8)
    senses.angular = 0.0
    judged = senses.verdict()
    assert judged.allowed == pytest.approx(SLOW)
    assert "silent beside where" in judged.reason.what


def test_what_was_heard_now_and_then_counts_ahead_and_not_beside() -> None:
    held = spot(is_sure=False)
    assert held.ahead(Pose(0.0, 0.0, 0.0)) is not None
    assert held.beside(Pose(0.0, 0.0, 0.0)) is None


@pytest.mark.parametrize("is_sure", [True, False])
def test_what_was_sure_stays_so_when_it_is_heard_now_and_then(is_sure: bool) -> None:
    held = spot(is_sure=is_sure)
    held.on_beam(beam("one", 1.0, robot_ns=10**9, is_sure=False))
    assert (held.beside(Pose(0.0, 0.0, 0.0)) is not None) is is_sure
    held.forget(round((CONFIG.silent_time + 0.5) * 1e9))
    assert held.beside(Pose(0.0, 0.0, 0.0)) is None
    assert held.ahead(Pose(0.0, 0.0, 0.0)) is not None


def test_beside_what_was_heard_now_and_then_the_way_is_free() -> None:
    senses = flickering()
    senses.angular = -1.0
    senses.cycle(None, cycles=8)
    senses.angular = 0.0
    assert "until lately" not in str(senses.verdict().reason)


def test_of_two_the_nearer_is_met_first() -> None:
    held = spot(1.0)
    for x in (0.8, 1.4):
        held.on_beam(beam("two", x))
    found = held.ahead(Pose(0.0, 0.0, 0.0))
    assert found is not None
    assert found.sensor == "two"
    assert found.distance == pytest.approx(0.4)


def test_the_oldest_of_too_many_go_and_one_that_is_heard_again_stays() -> None:
    held = spot(1.0)
    for number in range(1000):
        held.on_beam(beam("one", 1.0, Pose(float(number), 0.0, math.pi / 2.0), number))
        held.on_beam(beam("one", 1.0, robot_ns=number))
    assert len(held._spots) == 128
    assert held.ahead(Pose(0.0, 0.0, 0.0)) is not None
    assert held.ahead(Pose(999.0, 0.0, math.pi / 2.0)) is not None
    assert held.ahead(Pose(5.0, 0.0, math.pi / 2.0)) is None
