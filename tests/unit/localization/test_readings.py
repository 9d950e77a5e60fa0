"""What was heard since the last update, each where it was heard."""

import math

import pytest

from giraff_localization.beams.range_table import BIN, CLEAR
from giraff_localization.beams.readings import Readings
from giraff_localization.track import Track
from tests.support.robots import ULTRASONIC
from tests.unit.localization.rooms import echo, floor, odometry


def driven(metres: float = 0.1) -> Track:
    """Straight on, from second 1 to second 2."""
    way = Track()
    for step in range(11):
        way.on_odometry(odometry(1.0 + step / 10.0, x=metres * step / 10.0))
    return way


def readings() -> Readings:
    return Readings(ULTRASONIC, floor().sonars)


def test_a_reading_is_seen_from_where_the_robot_is_now() -> None:
    heard, way = readings(), driven()
    heard.on_range(echo("rear", 1.5, 1.0))
    heard.place(way)
    [beam] = heard.pop_beams(way.pose, 0.1)
    mount = ULTRASONIC["rear"]
    assert (beam.x, beam.y) == pytest.approx((mount.x - 0.05, mount.y))
    assert abs(math.remainder(beam.yaw - mount.yaw, math.tau)) < 1e-9
    assert beam.reading == pytest.approx(1.0 / BIN, abs=1)
    assert heard.pop_beams(way.pose, 0.1) == [], "and counts once"


@pytest.mark.parametrize("distance", [None, 4.0, 1e9])
def test_nothing_within_reach_is_clear(distance: float | None) -> None:
    heard, way = readings(), driven()
    heard.on_range(echo("rear", 1.5, distance))
    heard.place(way)
    assert [beam.reading for beam in heard.pop_beams(way.pose, 0.1)] == [CLEAR]


def test_the_readings_of_one_sensor_share_one_weight() -> None:
    heard, way = readings(), driven()
    for count, sensor in enumerate(ULTRASONIC, 1):
        for number in range(count):
            heard.on_range(echo(sensor, 1.2 + number / 10.0, 1.0))
    heard.place(way)
    shares = [beam.share for beam in heard.pop_beams(way.pose, 0.1)]
    assert shares == pytest.approx([0.2, 0.1, 0.1, *[0.2 / 3.0] * 3])


def test_what_comes_before_its_odometry_waits_for_it() -> None:
    heard, way = readings(), driven()
    heard.on_range(echo("rear", 2.05, 1.0))
    heard.place(way)
    assert heard.pop_beams(way.pose, 0.1) == []
    way.on_odometry(odometry(2.1, x=0.11))
    heard.place(way)
    assert len(heard.pop_beams(way.pose, 0.01)) == 1


def test_a_reading_of_the_future_holds_up_no_other() -> None:
    heard, way = readings(), driven()
    heard.on_range(echo("rear", 1e6, 1.0))
    heard.on_range(echo("rear", 1.5, 1.0))
    heard.place(way)
    assert len(heard.pop_beams(way.pose, 0.1)) == 1


def test_a_sensor_that_hears_nothing_for_long_says_nothing_until_it_does() -> None:
    heard, way = readings(), driven(3.0)

    def counted(distance: float | None) -> int:
        heard.on_range(echo("rear", 1.5, distance))
        heard.place(way)
        return len(heard.pop_beams(way.pose, 0.5))

    assert [counted(None) for _ in range(7)] == [1, 1, 1, 1, 1, 0, 0]
    assert [counted(1.0), counted(None)] == [1, 1]
