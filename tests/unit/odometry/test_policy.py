"""Counters to a pose: wraps, resets, gaps and leaps."""

import math
import random

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from giraff_core.kinematics.calibration import Calibration
from giraff_core.kinematics.dead_reckoning import Estimate
from giraff_core.kinematics.parts import PartPose
from giraff_core.kinematics.systematic_error import SystematicError
from giraff_core.live import Live
from giraff_odometry.config import OdometryConfig
from giraff_odometry.policy import OdometryPolicy
from giraff_schemas.messages import Odometry, Wheels
from giraff_schemas.trouble import NO_TROUBLE
from tests.unit.odometry.robots import PERIOD_US, ROBOT, wheels

CONFIG = OdometryConfig()
HALF_WRAP = 1 << 31
PERIOD_S = PERIOD_US / 1e6

speeds = st.lists(st.tuples(st.integers(-25, 25), st.integers(-25, 25)), min_size=1, max_size=40)
"""Counts of both wheels in each period: up to 1.25 m/s."""


def policy() -> OdometryPolicy:
    return OdometryPolicy(Live(CONFIG), ROBOT)


def followed(odometry: OdometryPolicy, *samples: Wheels) -> Odometry:
    """The last answer; each sample must have one."""
    answers = [odometry.on_wheels(sample) for sample in samples]
    assert None not in answers
    last = answers[-1]
    assert last is not None
    return last


def reports(way: list[tuple[int, int]], start_ticks: int = 0, start_us: int = 0) -> list[Wheels]:
    samples = [wheels(start_ticks, start_ticks, start_us)]
    left = right = start_ticks
    for step, (left_step, right_step) in enumerate(way, 1):
        left, right = left + left_step, right + right_step
        speeds = left_step / ROBOT.ticks_per_metre / PERIOD_S, right_step / ROBOT.ticks_per_metre / PERIOD_S
        samples.append(wheels(left, right, start_us + step * PERIOD_US, speeds=speeds))
    return samples


def pose(odometry: Odometry) -> tuple[float, float, float]:
    return odometry.x, odometry.y, odometry.yaw


DRIVING = reports([(10, 14)] * 50)
"""Half a second forward in a left bend."""


@pytest.fixture
def odometry() -> OdometryPolicy:
    return policy()


def test_it_starts_at_zero_wherever_the_counters_stand() -> None:
    start = followed(policy(), wheels(123456, -99, 77, boot_id=9))
    assert (*pose(start), start.linear_x, start.angular_z, start.path) == (0.0,) * 6
    assert start.covariance == (0.0,) * 6
    assert (start.board_us, start.boot_id, start.tick.epoch) == (77, 9, 3)


def test_it_tells_where_the_parts_of_the_robot_are() -> None:
    robot = msgspec.structs.replace(ROBOT, frames={"laser": PartPose(x=-0.115, z=0.226, pitch=0.1)})
    [laser] = OdometryPolicy(Live(CONFIG), robot).parts()
    assert (laser.parent, laser.child, laser.fixed) == ("base_link", "laser", True)
    assert (laser.x, laser.y, laser.z, laser.roll, laser.pitch, laser.yaw) == (-0.115, 0.0, 0.226, 0.0, 0.1, 0.0)


def test_the_way_back_counts_as_way() -> None:
    there_and_back = reports([(20, 20)] * 50 + [(-20, -20)] * 50)
    end = followed(policy(), *there_and_back)
    assert (end.x, end.path) == pytest.approx((0.0, 1.0))


def test_a_change_of_its_parameters_counts_at_once() -> None:
    live = Live(CONFIG)
    odometry = OdometryPolicy(live, ROBOT)
    live.replace(msgspec.structs.replace(CONFIG, max_wheel_speed=0.5))
    followed(odometry, *reports([(20, 20)]))
    assert odometry.breaks == 1
    assert "max_wheel_speed" in str(odometry.notice)


def test_pose_twist_and_path_of_a_bend() -> None:
    end = followed(policy(), *DRIVING)
    turn, path = 50 * 4 / 2000 / 0.47, 50 * 12 / 2000
    radius = path / turn
    assert pose(end) == pytest.approx((radius * math.sin(turn), radius * (1 - math.cos(turn)), turn))
    assert (end.path, end.linear_x, end.angular_z) == pytest.approx((path, path / 0.5, turn / 0.5))
    last = DRIVING[-1]
    assert (end.board_us, end.boot_id, end.tick) == (last.board_us, last.boot_id, last.tick)


@given(speeds, st.integers(HALF_WRAP - 500, HALF_WRAP + 500), st.integers(2 * HALF_WRAP - 200_000, 2 * HALF_WRAP))
def test_a_wrap_of_ticks_or_board_time_does_not_show(way: list[tuple[int, int]], ticks: int, board_us: int) -> None:
    plain, wrapping = policy(), policy()
    for one, other in zip(reports(way), reports(way, ticks, board_us), strict=True):
        expected, answer = plain.on_wheels(one), wrapping.on_wheels(other)
        assert expected is not None
        assert answer is not None
        assert pose(answer) == pose(expected)
        assert (answer.path, answer.linear_x, answer.covariance) == (
            expected.path,
            expected.linear_x,
            expected.covariance,
        )
    assert plain.breaks == wrapping.breaks == 0


@given(speeds)
def test_forward_and_backward_are_mirrored(way: list[tuple[int, int]]) -> None:
    """Both wheels reversed: what was ahead is behind, what was left of it lies right of it; the path is as long."""
    there = followed(policy(), *reports(way))
    mirrored = policy()
    mirrored.estimate = Estimate(direction=-1.0)
    back = followed(mirrored, *reports([(-right, -left) for left, right in way]))
    assert (back.x, back.y, back.yaw) == pytest.approx((-there.x, -there.y, there.yaw), abs=1e-9)
    assert (back.path, back.linear_x) == pytest.approx((there.path, -there.linear_x))


def interrupted(*samples: Wheels) -> tuple[OdometryPolicy, Odometry, Odometry]:
    """The answers before and at the samples, which come after DRIVING and are one break."""
    odometry = policy()
    before = followed(odometry, *DRIVING)
    assert odometry.breaks == 0
    after = followed(odometry, *samples)
    assert odometry.breaks == 1
    return odometry, before, after


NEXT_US = 51 * PERIOD_US
COUNTS = (DRIVING[-1].left_ticks, DRIVING[-1].right_ticks)

REBASES = {
    "reset of the board": (wheels(0, 0, 1000, boot_id=2, robot_s=1.5), "started again"),
    "reset with any counters": (wheels(HALF_WRAP, 5, NEXT_US, boot_id=2), "started again"),
    "another base": (wheels(*COUNTS, NEXT_US, instance="base-2"), "another base process"),
    "leap": (wheels(COUNTS[0] + 5000, COUNTS[1], NEXT_US), "leapt"),
    "leap by half the range": (wheels(COUNTS[0], COUNTS[1] + HALF_WRAP, NEXT_US), "leapt"),
    "silence beyond the board's clock": (wheels(*COUNTS, NEXT_US + HALF_WRAP + 1), "may have wrapped"),
}


@pytest.mark.parametrize(("sample", "words"), REBASES.values(), ids=REBASES)
def test_what_cannot_be_followed_costs_certainty_and_moves_nothing(sample: Wheels, words: str) -> None:
    odometry, before, after = interrupted(sample)
    assert pose(after) == pose(before)
    assert after.path == before.path
    assert (after.linear_x, after.angular_z) == (0.0, 0.0)
    assert words in str(odometry.notice)
    growth = [now - then for now, then in zip(after.covariance, before.covariance, strict=True)]
    assert growth == pytest.approx([0.04, 0.0, 0.0, 0.04, 0.0, 0.35**2])

    onward = msgspec.structs.replace(
        sample,
        left_ticks=sample.left_ticks + 10,
        right_ticks=sample.right_ticks + 10,
        board_us=sample.board_us + PERIOD_US,
    )
    moved = followed(odometry, onward)
    assert moved.path == pytest.approx(before.path + 10 / 2000)
    assert (odometry.breaks, odometry.notice) == (1, NO_TROUBLE)


def test_a_gap_keeps_the_wheels_travel_and_costs_certainty_by_it() -> None:
    late = wheels(COUNTS[0] + 1000, COUNTS[1] + 1000, 50 * PERIOD_US + 1_000_000, speeds=(0.4, 0.4))
    odometry, before, after = interrupted(late)
    assert after.path == pytest.approx(before.path + 0.5)
    assert after.x == pytest.approx(before.x + 0.5 * math.cos(before.yaw))
    assert after.linear_x == pytest.approx(0.4)  # as the board measures it now, not the average of the gap
    assert "gap" in str(odometry.notice)
    assert after.covariance[0] - before.covariance[0] == pytest.approx(0.25**2, rel=0.01)
    heading = 2.0 * ROBOT.wheel_noise * 0.5 / ROBOT.track_width**2  # known as well as ever: the arc's shape is not
    assert after.covariance[5] - before.covariance[5] == pytest.approx(heading)


def test_a_gap_at_rest_costs_nothing() -> None:
    _, before, after = interrupted(wheels(*COUNTS, 50 * PERIOD_US + 60_000_000))
    assert (pose(after), after.covariance) == (pose(before), before.covariance)


def test_an_encoder_that_flickers_at_rest_is_no_speed_and_no_doubt() -> None:
    flicker = [
        wheels(COUNTS[0] + period // 2 % 2, COUNTS[1], NEXT_US + period * PERIOD_US, speeds=(0.008, 0.0))
        for period in range(100)
    ]
    odometry = policy()
    before = followed(odometry, *DRIVING, *flicker[:25])
    after = followed(odometry, *flicker[25:])
    assert (after.linear_x, after.angular_z) == (0.0, 0.0)
    assert after.covariance == pytest.approx(before.covariance, rel=0.01)
    assert pose(after) == pytest.approx(pose(before), abs=0.002)


def test_a_few_lost_samples_are_no_gap(odometry: OdometryPolicy) -> None:
    whole = followed(policy(), *DRIVING)
    thinned = followed(odometry, *DRIVING[::10])
    assert pose(thinned) == pytest.approx(pose(whole), abs=1e-9)
    assert odometry.breaks == 0


def test_repeated_and_late_samples_count_for_nothing(odometry: OdometryPolicy) -> None:
    before = followed(odometry, *DRIVING)
    for sample in (DRIVING[-1], DRIVING[-2], DRIVING[0], wheels(9999, 9999, -5)):
        assert odometry.on_wheels(sample) is None
    after = followed(odometry, wheels(COUNTS[0] + 10, COUNTS[1] + 14, NEXT_US))
    assert after.path == pytest.approx(before.path + 12 / 2000)
    assert odometry.breaks == 0


@given(speeds, st.randoms(use_true_random=False))
def test_whatever_the_network_repeats_the_pose_is_that_of_the_samples_in_order(
    way: list[tuple[int, int]], rng: random.Random
) -> None:
    samples = reports(way)
    disturbed, odometry = [], policy()
    for number, sample in enumerate(samples):
        disturbed += [sample, rng.choice(samples[: number + 1])]
    answers = [answer for sample in disturbed if (answer := odometry.on_wheels(sample)) is not None]
    assert answers[-1] == followed(policy(), *samples)


def test_the_fastest_a_wheel_may_be_is_believed_and_not_much_more() -> None:
    for counts, breaks in ((30 + 4, 0), (30 + 5, 1)):  # 1.5 m/s for 10 ms at 2000 a metre, and the slack
        odometry = policy()
        followed(odometry, wheels(), wheels(counts, -counts, PERIOD_US))
        assert odometry.breaks == breaks


anything = st.builds(
    wheels,
    st.integers(),
    st.integers(),
    st.integers(),
    boot_id=st.integers(1, 2),
    instance=st.sampled_from(["base-1", "base-2"]),
    robot_s=st.floats(0.0, 1e6),
)


@given(st.lists(anything, max_size=20))
def test_no_samples_make_a_leap_or_anything_but_numbers(samples: list[Wheels]) -> None:
    odometry = policy()
    last = followed(odometry, wheels())
    for sample in samples:
        answer = odometry.on_wheels(sample)
        if answer is None:
            continue
        elapsed = (answer.board_us - last.board_us) % (1 << 32) / 1e6
        assert math.dist((answer.x, answer.y), (last.x, last.y)) <= CONFIG.max_wheel_speed * elapsed + 4 / 2000 + 1e-9
        assert all(map(math.isfinite, (*pose(answer), answer.linear_x, answer.angular_z, answer.path)))
        assert all(map(math.isfinite, answer.covariance))
        last = answer


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ({"max_wheel_speed": 0.0}, r"max_wheel_speed is 0: it must be within 0\.05\.\.20 m/s"),
        ({"max_gap": math.inf}, "max_gap is inf: it must be within .*; are these milliseconds"),
        ({"lost_position": 1.7e308}, r"lost_position is 1.7e\+308: it must be within 0\.\.10 m"),
        ({"lost_yaw": math.nan}, "lost_yaw is nan: it must be within 0..2π rad"),
        ({"track_width": 0.5}, "unknown field `track_width`"),
    ],
)
def test_a_senseless_configuration_is_refused_in_clear_words(table: dict[str, float], words: str) -> None:
    assert msgspec.convert({}, OdometryConfig) == CONFIG
    with pytest.raises(msgspec.ValidationError, match=words):
        msgspec.convert(table, OdometryConfig)


def test_speeds_are_the_boards_own() -> None:
    start, moving = wheels(), wheels(10, 10, PERIOD_US, speeds=(0.2, 0.294))
    answer = followed(policy(), start, moving)
    assert (answer.linear_x, answer.angular_z) == pytest.approx((0.247, 0.2))


def test_a_speed_that_no_wheel_can_have_is_not_believed_and_the_travel_is_gone_by(odometry: OdometryPolicy) -> None:
    answer = followed(odometry, wheels(), wheels(10, 10, PERIOD_US, speeds=(0.5, -1.6)))
    assert (answer.linear_x, answer.angular_z) == pytest.approx((0.5, 0.0))
    assert "max_wheel_speed" in str(odometry.notice)
    assert odometry.breaks == 0


def test_each_wheel_and_the_track_go_by_the_calibration() -> None:
    found = Calibration(left_wheel_scale=1.02, right_wheel_scale=0.98, track_scale=1.1)
    robot = msgspec.structs.replace(ROBOT, calibration=found)
    answer = followed(OdometryPolicy(Live(CONFIG), robot), wheels(), wheels(20, 20, PERIOD_US))
    assert answer.path == pytest.approx(0.01)
    assert answer.yaw == pytest.approx(-0.04 * 0.01 / (1.1 * ROBOT.track_width))


def test_what_is_systematic_is_in_the_covariance_beside_what_is_random() -> None:
    doubted = msgspec.structs.replace(ROBOT, calibration=Calibration())
    sure, doubtful = (followed(OdometryPolicy(Live(CONFIG), robot), *DRIVING) for robot in (ROBOT, doubted))
    assert pose(sure) == pose(doubtful)
    shares = SystematicError(doubted.calibration, ROBOT.kinematics)
    for _ in range(50):
        shares.advance(10 / 2000, 14 / 2000)
    both = [one + other for one, other in zip(sure.covariance, shares.covariance(), strict=True)]
    assert doubtful.covariance == pytest.approx(both)
