"""A pose that is set from outside: where it then is, how sure that is, and how it goes on."""

import itertools
import math
import re

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from giraff_core.kinematics.calibration import Calibration
from giraff_core.live import Live
from giraff_odometry.config import OdometryConfig
from giraff_odometry.policy import OdometryPolicy
from giraff_schemas.messages import Odometry, Wheels
from giraff_schemas.requests import OdomAnswer, OdomReset, OdomSetPose
from giraff_schemas.trouble import NO_TROUBLE
from tests.unit.odometry.robots import PERIOD_US, ROBOT, wheels

UNSURE = msgspec.structs.replace(ROBOT, calibration=Calibration())
"""Nobody has calibrated it."""
WAY = [wheels(10 * step, 14 * step, step * PERIOD_US) for step in range(51)]
"""Half a second forward in a left bend, 1.0 and 1.4 m/s."""
ids = itertools.count(1)


def reset() -> OdomReset:
    return OdomReset(by="ann@desk", id=next(ids))


def there(x: float = 2.0, y: float = -1.0, yaw: float = 0.5, **sure: float) -> OdomSetPose:
    return OdomSetPose(by="ann@desk", id=next(ids), x=x, y=y, yaw=yaw, **sure)


def driven(*samples: Wheels) -> OdometryPolicy:
    odometry = OdometryPolicy(Live(OdometryConfig()), UNSURE)
    for sample in samples:
        assert odometry.on_wheels(sample) is not None
    return odometry


def onward(odometry: OdometryPolicy, steps: int, *, moves: bool = True) -> Odometry:
    """So many periods more, as before or at rest."""
    last = WAY[-1]
    said = None
    for step in range(1, steps + 1):
        left, right = (10 * step, 14 * step) if moves else (0, 0)
        sample = wheels(last.left_ticks + left, last.right_ticks + right, last.board_us + step * PERIOD_US)
        said = odometry.on_wheels(sample)
    assert said is not None
    return said


def pose(odometry: Odometry) -> tuple[float, float, float]:
    return odometry.x, odometry.y, odometry.yaw


@pytest.fixture
def odometry() -> OdometryPolicy:
    return driven(*WAY)


def test_a_reset_begins_anew_here(odometry: OdometryPolicy) -> None:
    assert odometry.on_reset(reset()) == OdomAnswer(done=True, jumps=1)
    now = onward(odometry, 1, moves=False)
    assert (*pose(now), now.path) == (0.0,) * 4
    assert now.covariance == (0.0,) * 6
    assert (now.jumps, odometry.breaks, odometry.notice) == (1, 0, NO_TROUBLE)


def test_a_pose_that_was_set_is_gone_on_from_and_the_path_is_kept(odometry: OdometryPolicy) -> None:
    path = odometry.estimate.path
    assert odometry.on_set_pose(there(position_sd=0.05, yaw_sd=0.1)) == OdomAnswer(done=True, jumps=1)
    now = onward(odometry, 1, moves=False)
    assert pose(now) == (2.0, -1.0, 0.5)
    assert now.path == path == pytest.approx(0.3)
    assert now.covariance == pytest.approx((0.0025, 0.0, 0.0, 0.0025, 0.0, 0.01))


def test_what_is_given_for_sure_is_sure(odometry: OdometryPolicy) -> None:
    odometry.on_set_pose(there())
    assert onward(odometry, 1, moves=False).covariance == (0.0,) * 6


@pytest.mark.parametrize("wish", [reset(), there()], ids=["reset", "set"])
def test_the_same_wish_asked_again_does_nothing_and_is_answered(wish: OdomReset | OdomSetPose) -> None:
    """A client asks until it hears an answer: its own last word must not undo what the robot has driven since."""
    odometry = driven(*WAY)

    def ask() -> OdomAnswer:
        return odometry.on_reset(wish) if isinstance(wish, OdomReset) else odometry.on_set_pose(wish)

    first = ask()
    before = onward(odometry, 20)
    assert ask() == first
    assert (odometry.jumps, odometry.estimate.path) == (1, before.path)
    assert (odometry.estimate.x, odometry.estimate.y) == (before.x, before.y)


def test_each_wish_is_a_jump_of_its_own(odometry: OdometryPolicy) -> None:
    answers = [odometry.on_reset(reset()), odometry.on_set_pose(there()), odometry.on_reset(reset())]
    assert [answer.jumps for answer in answers] == [1, 2, 3]


def test_a_wish_comes_before_any_wheels() -> None:
    odometry = driven()
    assert odometry.on_set_pose(there()).done
    first = odometry.on_wheels(WAY[0])
    assert first is not None
    assert (*pose(first), first.jumps) == (2.0, -1.0, 0.5, 1)


@given(st.floats(-1000.0, 1000.0))
def test_a_yaw_of_any_turns_is_wrapped(yaw: float) -> None:
    odometry = driven(*WAY)
    odometry.on_set_pose(there(yaw=yaw))
    now = odometry.estimate.yaw
    assert -math.pi < now <= math.pi
    assert (math.cos(now), math.sin(now)) == pytest.approx((math.cos(yaw), math.sin(yaw)), abs=1e-9)


def test_set_while_it_moves_the_wheels_go_on_without_a_leap() -> None:
    """The same way from another place: turned and moved as a whole, with the same twist and the same errors."""
    moved = driven(*WAY)
    moved.on_set_pose(there())
    first = onward(moved, 1)
    assert math.dist((first.x, first.y), (2.0, -1.0)) == pytest.approx(12 / 2000)
    moved = driven(*WAY)
    moved.on_set_pose(there())
    last = onward(moved, 51)
    cos, sin = math.cos(0.5), math.sin(0.5)
    plain = onward_from_zero()
    x, y, yaw = pose(plain)
    assert pose(last) == pytest.approx((2.0 + cos * x - sin * y, -1.0 + sin * x + cos * y, 0.5 + yaw))
    assert (last.linear_x, last.angular_z) == (plain.linear_x, plain.angular_z)
    assert (last.boot_id, last.jumps) == (plain.boot_id, 1)


def onward_from_zero() -> Odometry:
    """The next 51 periods of one that was reset."""
    odometry = driven(*WAY)
    odometry.on_reset(reset())
    return onward(odometry, 51)


def test_after_a_reset_errors_grow_as_of_one_that_has_just_begun() -> None:
    begun = driven(*WAY)
    fresh = begun.on_wheels(wheels(51 * 10, 51 * 14, 51 * PERIOD_US))
    assert fresh is not None
    again = onward_from_zero()
    assert again.covariance == pytest.approx(fresh.covariance)
    assert pose(again) == pytest.approx(pose(fresh))


@pytest.mark.parametrize(
    ("request_", "words"),
    [
        (there(x=1e300), r"x is 1e\+300: it must be within -1e\+06..1e\+06 m; are these millimetres"),
        (there(y=-1e300), r"y is -1e\+300"),
        (there(yaw=1e308), r"yaw is 1e\+308: it must be within -10000..10000 rad; are these degrees"),
        (there(position_sd=1e200), "position_sd is .* within 0..10000 m"),
        (there(yaw_sd=10.0), "yaw_sd is 10: it must be within 0..2π rad; are these degrees"),
    ],
)
def test_what_no_robot_can_be_at_is_refused_with_the_reason(request_: OdomSetPose, words: str) -> None:
    odometry = driven(*WAY)
    before = odometry.estimate
    answer = odometry.on_set_pose(request_)
    assert (answer.done, answer.jumps) == (False, 0)
    assert re.search(words, str(answer.reason)), answer.reason
    assert odometry.estimate is before


SETTABLE = st.builds(
    there,
    st.floats(-1e6, 1e6),
    st.floats(-1e6, 1e6),
    st.floats(-1e4, 1e4),
    position_sd=st.floats(0.0, 1e4),
    yaw_sd=st.floats(0.0, math.tau),
)


@given(SETTABLE)
def test_whatever_is_settable_leaves_numbers(request_: OdomSetPose) -> None:
    odometry = driven(*WAY)
    assert odometry.on_set_pose(request_).done
    now = onward(odometry, 50)
    assert all(map(math.isfinite, (*pose(now), *now.covariance)))
