"""The robot's way, whatever becomes of `odom`."""

import math

import msgspec
import pytest

from giraff_localization.track import Track
from giraff_schemas.messages import RobotTime
from tests.unit.localization.rooms import moment, odometry


def straight_on(way: Track, metres: float, steps: int = 10) -> None:
    for step in range(1, steps + 1):
        way.on_odometry(odometry(step / 100.0, x=metres * step / steps))


@pytest.fixture
def way() -> Track:
    return Track()


def test_it_follows_odometry(way: Track) -> None:
    way.on_odometry(odometry(0.0, x=5.0, y=-2.0, yaw=math.pi / 2.0))
    way.on_odometry(odometry(0.01, x=5.0, y=-1.9, yaw=math.pi / 2.0))
    assert way.pose == pytest.approx((0.1, 0.0, 0.0))
    assert (way.way, way.turned) == pytest.approx((0.1, 0.0))


def test_a_stride_is_seen_from_its_beginning_and_taken_once(way: Track) -> None:
    way.on_odometry(odometry(0.0))
    straight_on(way, 0.2)
    assert way.pop_stride().forward == pytest.approx(0.2)
    assert way.pop_stride()[:6] == (0.0,) * 6


def test_backward_counts_negative_along_the_way(way: Track) -> None:
    way.on_odometry(odometry(0.0))
    straight_on(way, -0.2)
    stride = way.pop_stride()
    assert (stride.x, stride.forward, stride.way) == pytest.approx((-0.2, -0.2, 0.2))


def test_whole_turns_are_counted(way: Track) -> None:
    for step in range(25):
        way.on_odometry(odometry(step / 10.0, yaw=math.remainder(step * math.pi / 8.0, math.tau)))
    assert way.pop_stride().turn == pytest.approx(3.0 * math.pi)


def test_a_pose_that_was_set_is_no_motion(way: Track) -> None:
    way.on_odometry(odometry(0.0))
    way.on_odometry(odometry(0.01, x=1.0, y=1.0, yaw=2.0, jumps=1))
    assert (way.way, way.turned, way.has_missed) == (0.0, 0.0, False)
    way.on_odometry(odometry(0.02, x=1.0 + 0.1 * math.cos(2.0), y=1.0 + 0.1 * math.sin(2.0), yaw=2.0, jumps=1))
    assert way.pose == pytest.approx((0.1, 0.0, 0.0))


@pytest.mark.parametrize(("silent", "position"), [(0.5, 0.15), (100.0, 1.5)])
def test_odometry_that_was_started_again_has_missed_what_went_on_meanwhile(silent: float, position: float) -> None:
    way = Track()
    way.on_odometry(odometry(0.0, x=3.0))
    way.on_odometry(odometry(silent, instance="another"))
    assert way.way == 0.0
    assert way.has_missed
    assert way.pop_stride().missed[0] == pytest.approx(position)
    assert not way.has_missed


def test_what_odometry_says_that_it_lost_is_taken_over(way: Track) -> None:
    way.on_odometry(odometry(0.0))
    lost = msgspec.structs.replace(odometry(0.01), covariance=(0.04, 0.0, 0.0, 0.04, 0.0, 0.1225), breaks=1)
    way.on_odometry(lost)
    assert way.has_missed
    assert way.pop_stride().missed == pytest.approx((0.2, 0.35))


@pytest.mark.parametrize("far", [6.0, 1e300])
def test_a_leap_that_no_robot_makes_is_none(way: Track, far: float) -> None:
    way.on_odometry(odometry(0.0))
    way.on_odometry(odometry(1.0, x=-far, y=far))
    assert way.pose == (0.0, 0.0, 0.0)
    assert way.pop_stride().missed[0] == pytest.approx(0.3)


def test_two_odometries_at_once_do_not_make_each_sample_an_update(way: Track) -> None:
    for step in range(10):
        way.on_odometry(odometry(step / 100.0, instance=("one", "two")[step % 2]))
    assert not way.has_missed


def test_what_a_long_way_adds_to_the_covariance_is_no_loss(way: Track) -> None:
    """It grows by the error that was there before; the scales that make it are in the particles."""
    way.on_odometry(msgspec.structs.replace(odometry(0.0), covariance=(25.0, 0.0, 2.0, 25.0, 1.0, 0.8)))
    grown = msgspec.structs.replace(odometry(0.01, x=0.004), covariance=(25.1, 0.0, 2.0, 25.1, 1.1, 0.81))
    way.on_odometry(grown)
    assert not way.has_missed


def test_a_reading_is_put_to_where_it_was_taken(way: Track) -> None:
    way.on_odometry(odometry(0.0))
    straight_on(way, 0.1, steps=2)
    assert way.at(moment(0.005)) == pytest.approx((0.025, 0.0, 0.0))
    assert way.is_ahead(moment(0.021))
    assert not way.is_ahead(moment(0.02))


def test_of_a_moment_before_odometry_or_in_a_gap_nobody_can_tell(way: Track) -> None:
    assert way.is_ahead(moment(1.0))
    way.on_odometry(odometry(1.0))
    way.on_odometry(odometry(3.0, x=1.0))
    assert way.at(moment(0.5)) is None
    assert way.at(moment(2.0)) is None
    assert way.at(RobotTime(epoch=99, robot_ns=1)) is None


def test_an_old_sample_says_nothing(way: Track) -> None:
    way.on_odometry(odometry(1.0, x=1.0))
    way.on_odometry(odometry(0.5, x=0.0))
    assert way.way == 0.0


def test_it_remembers_no_more_than_some_seconds(way: Track) -> None:
    for step in range(2000):
        way.on_odometry(odometry(step / 100.0, x=step / 1000.0))
    assert len(way._moments) == 400
