"""One short reading stops, one long reading never opens: what it takes to believe a sensor again."""

import math

import msgspec
import pytest

from giraff_guard.config import GuardConfig
from tests.unit.guard.senses import CONFIG, CYCLE, FAR, FRONT, NEAR, ROBOT, Senses, opened, robot_with

SLOT = CYCLE / 3


NOT_HELD = msgspec.structs.replace(CONFIG, silent_range=0.1)
"""What falls silent is gone."""


def stepped_in(sensors: tuple[str, ...] = FRONT, config: GuardConfig = CONFIG) -> Senses:
    """Somebody has stepped in front of these sensors, and was heard twice."""
    senses = opened(config=config)
    senses.cycle(dict.fromkeys(sensors, NEAR), cycles=2)
    return senses


@pytest.mark.parametrize("longer", [None, 4.0, 2.0, 1.0], ids=str)
@pytest.mark.parametrize("sensors", [FRONT, FRONT[:1], FRONT[1:]], ids=" ".join)
def test_one_long_reading_never_opens(sensors: tuple[str, ...], longer: float | None) -> None:
    senses = stepped_in(sensors)
    for _ in range(10):
        senses.cycle(dict.fromkeys(sensors, longer))
        assert senses.allowed() == 0.0
        senses.cycle(dict.fromkeys(sensors, NEAR))
        assert senses.allowed() == 0.0


@pytest.mark.parametrize("longer", [None, 2.0], ids=str)
@pytest.mark.parametrize("sensors", [FRONT, FRONT[:1], FRONT[1:], ("rear",)], ids=" ".join)
def test_two_contrary_readings_release_to_creep_and_each_further_one_adds_speed(
    sensors: tuple[str, ...], longer: float | None
) -> None:
    way = "backward" if sensors == ("rear",) else "forward"
    senses = stepped_in(sensors, NOT_HELD)
    senses.cycle(dict.fromkeys(sensors, longer), cycles=2)
    allowed = [senses.allowed(way)]
    assert "it speeds up" in str(senses.verdict(way).reason)
    for _ in range(6):
        senses.cycle(dict.fromkeys(sensors, longer))
        allowed.append(senses.allowed(way))
    assert allowed == pytest.approx([0.1, 0.22, 0.34, 0.46, 0.58, 0.6, 0.6])


def test_readings_of_another_sensor_add_no_speed() -> None:
    senses = stepped_in(("front_left",))
    senses.cycle({"front_left": FAR}, cycles=2)
    for _ in range(8):
        senses.wait(0.02)
        senses.hear(FAR, "front_right")
    assert senses.allowed() == pytest.approx(0.1)


def test_a_short_reading_on_the_way_back_to_speed_begins_anew() -> None:
    senses = stepped_in()
    senses.cycle(FAR, cycles=4)
    assert senses.allowed() > 0.3
    senses.cycle({"front_left": NEAR})
    assert senses.allowed() == 0.0
    senses.cycle(FAR, cycles=2)
    assert senses.allowed() <= 0.22


def alone(sensor: str, *, before: float | None = FAR, after: float | None = FAR, witness: float | None = FAR) -> float:
    """What is allowed once a short reading was followed by one of the neighbour and one of its own sensor."""
    senses = opened()
    senses.cycle(before, cycles=6)
    other = "front_right" if sensor == "front_left" else "front_left"
    senses.wait(SLOT if sensor == "front_left" else 2 * SLOT)
    senses.hear(NEAR, sensor)
    assert senses.allowed() == 0.0
    senses.wait(SLOT)
    senses.hear(witness, other)
    assert senses.allowed() == 0.0
    senses.wait(2 * SLOT)
    senses.hear(after, sensor)
    return senses.allowed()


@pytest.mark.parametrize("sensor", FRONT)
@pytest.mark.parametrize("after", [None, FAR, 1.0, 3.9], ids=str)
def test_a_short_reading_that_stands_alone_is_outvoted_and_released_to_creep(sensor: str, after: float | None) -> None:
    assert alone(sensor, after=after) == pytest.approx(0.1)


@pytest.mark.parametrize("sensor", FRONT)
def test_it_is_not_alone_where_a_neighbour_hears_it_too(sensor: str) -> None:
    assert alone(sensor, witness=NEAR) == 0.0
    assert alone(sensor, witness=NEAR + 0.1) == 0.0


@pytest.mark.parametrize("sensor", FRONT)
def test_it_is_not_alone_where_something_came_nearer_to_it(sensor: str) -> None:
    assert alone(sensor, before=0.5) == 0.0


def test_it_is_not_alone_where_it_was_heard_a_second_ago(senses: Senses) -> None:
    """True, wild, true, wild: what was there is there."""
    senses.cycle({"front_left": NEAR})
    senses.cycle({"front_left": FAR})
    for _ in range(5):
        senses.cycle({"front_left": NEAR})
        assert senses.allowed() == 0.0
        senses.cycle({"front_left": FAR})
        assert senses.allowed() == 0.0


def test_without_a_neighbour_it_takes_two_of_its_own() -> None:
    senses = opened(robot_with("front_left", "rear"))
    for expected in (0.0, 0.0, 0.1):
        senses.cycle({"front_left": NEAR if expected == 0.0 and senses.allowed() > 0.0 else FAR})
        assert senses.allowed() == pytest.approx(expected)


def test_a_neighbour_that_was_heard_before_it_is_no_witness(senses: Senses) -> None:
    senses.hear(FAR, "front_right")
    senses.wait(0.02)
    senses.hear(NEAR, "front_left")
    senses.wait(0.1)
    senses.hear(FAR, "front_left")
    assert senses.allowed() == 0.0


def test_a_person_who_walks_away_is_followed(senses: Senses) -> None:
    """At walking speed each reading follows from the one before: no echo is lost, and nothing stays blocked."""
    distance = 0.06
    senses.cycle(dict.fromkeys(FRONT, distance), cycles=3)
    assert senses.allowed() == 0.0
    while distance < 2.0:
        distance += 0.9 * CYCLE
        senses.cycle(dict.fromkeys(FRONT, distance))
    assert senses.allowed() > 0.0


def lost_at(distance: float, then: float | None = None) -> Senses:
    senses = opened()
    senses.cycle({"front_left": distance}, cycles=3)
    senses.cycle({"front_left": then}, cycles=5)
    return senses


@pytest.mark.parametrize("then", [None, 3.0], ids=str)
@pytest.mark.parametrize(("distance", "blocked"), [(0.05, True), (0.09, True), (0.11, False)])
def test_an_echo_lost_that_near_may_touch_the_sensor(distance: float, blocked: bool, then: float | None) -> None:
    senses = lost_at(distance, then)
    assert (senses.allowed() == 0.0) is blocked
    senses.cycle({"front_left": then}, cycles=30)
    assert (senses.allowed() == 0.0) is blocked
    if blocked:
        judged = senses.verdict()
        assert judged.sensor == "front_left"
        assert "lost something nearer than 0.1 m" in judged.reason.what
        assert "back up" in judged.reason.remedy


def test_backing_away_frees_it() -> None:
    senses = lost_at(0.05)
    senses.linear = -0.1
    senses.cycle(None, cycles=7)
    assert "lost" in str(senses.verdict().reason)
    senses.cycle(None, cycles=5)
    assert senses.allowed() > 0.0


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_turning_away_frees_it(side: float) -> None:
    senses = lost_at(0.05)
    senses.angular = side * math.radians(28.0)
    senses.wait(1.0)
    assert senses.allowed() == 0.0
    senses.cycle(cycles=3)
    senses.angular = 0.0
    senses.cycle(cycles=3)
    assert senses.allowed() > 0.0


def test_one_wild_reading_that_near_is_not_lost(senses: Senses) -> None:
    senses.cycle({"front_left": 0.05})
    senses.cycle(cycles=3)
    assert senses.allowed() > 0.0


def test_what_is_heard_that_near_again_is_not_lost() -> None:
    senses = lost_at(0.05)
    senses.cycle({"front_left": 0.08}, cycles=2)
    for distance in (0.2, 0.35, 0.5, 0.7, 0.9, 1.0, 1.2):
        senses.cycle({"front_left": distance})
    assert senses.allowed() > 0.0


def test_with_sensors_proven_a_free_way_is_not_refused_for_a_second() -> None:
    """Whatever wild reading comes, alone."""
    for wild in [*(d / 100 for d in range(2, 100, 7)), None]:
        for sensor in ROBOT.sensors:
            senses = opened()
            senses.cycle({sensor: wild})
            refused = 0.0
            for _ in range(5):
                senses.cycle()
                refused += CYCLE * (senses.allowed() == 0.0 or senses.allowed("backward") == 0.0)
            assert refused <= 2 * CYCLE
