"""Six robots that may as well be this one, against thousands drawn at random."""

import math
import random
import statistics

import pytest
from hypothesis import given
from hypothesis import strategies as st

from giraff_core.kinematics.calibration import EXACTLY, Calibration, Covariance
from giraff_core.kinematics.differential_drive import DifferentialDrive
from giraff_core.kinematics.pose import Pose
from giraff_core.kinematics.systematic_error import SystematicError

DRIVE = DifferentialDrive(0.47, max_wheel_speed=0.6)
DOUBTED = Calibration()
ORIGIN = Pose(0.0, 0.0, 0.0)
Way = list[tuple[float, float]]

STRAIGHT: Way = [(0.02, 0.02)] * 150
HALF_TURN: Way = [(-0.01, 0.01)] * round(math.pi * 0.47 / 2.0 / 0.01)
THERE_AND_BACK = STRAIGHT + HALF_TURN + STRAIGHT
BEND: Way = [(0.02, 0.03)] * 60


def after(way: Way, calibration: Calibration = DOUBTED, start: Pose = ORIGIN) -> Covariance:
    error = SystematicError(calibration, DRIVE)
    error.begin(start)
    for left, right in way:
        error.advance(left, right)
    return error.covariance()


def driven(way: Way, left_scale: float, right_scale: float, track_scale: float) -> tuple[float, float, float]:
    """Where a robot of these scales ends: no arc in sight, and small steps."""
    x = y = yaw = 0.0
    for left, right in way:
        turn = (right * right_scale - left * left_scale) / DRIVE.track_width / track_scale
        step = (left * left_scale + right * right_scale) / 2.0
        x, y, yaw = x + step * math.cos(yaw + turn / 2.0), y + step * math.sin(yaw + turn / 2.0), yaw + turn
    return x, y, yaw


@pytest.mark.parametrize("way", [STRAIGHT, BEND], ids=["line", "bend"])
def test_the_error_is_that_of_robots_drawn_as_the_calibration_says(way: Way) -> None:
    for (one, other), told, true, scale in compared(way):
        assert told == pytest.approx(true, abs=0.15 * scale), (one, other)


def test_where_the_first_order_cancels_it_says_half_at_least() -> None:
    """Six robots differ in one scale each: what takes two at once is not in it. Jacobians say next to nothing."""
    (_, told, true, _), *_ = compared(THERE_AND_BACK)
    assert 0.5 < told / true < 1.2


def compared(way: Way) -> list[tuple[tuple[int, int], float, float, float]]:
    """For each two of x, y, yaw: their covariance as told and as drawn, and the product of their deviations."""
    rng, here = random.Random(1), driven(way, 1.0, 1.0, 1.0)
    wheel, track = math.sqrt(DOUBTED.covariance[0]), math.sqrt(DOUBTED.covariance[5])
    ends = [
        driven(way, rng.gauss(1.0, wheel), rng.gauss(1.0, wheel), rng.gauss(1.0, track))  # as by default: independent
        for _ in range(1000)
    ]
    off = list(zip(*[[a - b for a, b in zip(end, here, strict=True)] for end in ends], strict=True))
    scales = [math.sqrt(statistics.fmean(value * value for value in axis)) for axis in off]
    pairs = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)]
    return [
        (
            (one, other),
            told,
            statistics.fmean(a * b for a, b in zip(off[one], off[other], strict=True)),
            scales[one] * scales[other],
        )
        for (one, other), told in zip(pairs, after(way), strict=True)
    ]


def test_a_straight_line_is_off_by_its_length_and_to_the_side_by_its_square() -> None:
    xx, xy, _, yy, _, tt = after(STRAIGHT)
    length, wheel = 3.0, math.sqrt(DOUBTED.covariance[0])
    heading = math.sqrt(2.0) * wheel * length / DRIVE.track_width
    assert math.sqrt(xx) == pytest.approx(wheel / math.sqrt(2.0) * length, rel=0.05)
    assert math.sqrt(tt) == pytest.approx(heading, rel=0.02)
    assert math.sqrt(yy) == pytest.approx(heading * length / 2.0, rel=0.02)
    assert abs(xy) < 0.01 * math.sqrt(xx * yy)


@given(st.floats(-3.0, 3.0), st.floats(-5.0, 5.0))
def test_it_turns_with_the_way(yaw: float, x: float) -> None:
    xx, xy, xt, yy, yt, tt = after(BEND)
    turned = after(BEND, start=Pose(x, 2.0, yaw))
    cos, sin = math.cos(yaw), math.sin(yaw)
    assert turned == pytest.approx(
        (
            cos * cos * xx - 2.0 * cos * sin * xy + sin * sin * yy,
            cos * sin * (xx - yy) + (cos * cos - sin * sin) * xy,
            cos * xt - sin * yt,
            sin * sin * xx + 2.0 * cos * sin * xy + cos * cos * yy,
            sin * xt + cos * yt,
            tt,
        ),
        abs=1e-9,
    )


@pytest.mark.parametrize("correlation", [0.0, 0.6, -0.6])
def test_turns_on_the_spot_are_off_by_the_track_and_go_on_past_half_a_turn(correlation: float) -> None:
    """A track that is wider together with larger wheels turns the robot as far: their errors cancel."""
    aa, ab, _, bb, _, cc = DOUBTED.covariance
    both = correlation * math.sqrt(aa * cc)
    *_, tt = after(HALF_TURN * 21, Calibration(covariance=(aa, ab, both, bb, both, cc)))
    turned = 2.0 * 0.01 * len(HALF_TURN) * 21 / DRIVE.track_width
    assert math.sqrt(tt) == pytest.approx(turned * math.sqrt(aa / 2.0 + cc - 2.0 * both), rel=0.02)


def test_what_was_calibrated_is_off_by_less() -> None:
    aa, ab, ac, bb, bc, cc = (value / 100.0 for value in DOUBTED.covariance)
    better = Calibration(left_wheel_scale=1.01, right_wheel_scale=0.99, covariance=(aa, ab, ac, bb, bc, cc))
    for told, before in zip(after(STRAIGHT, better), after(STRAIGHT), strict=True):
        assert told == pytest.approx(before / 100.0, rel=0.05, abs=1e-6)


def test_whoever_is_sure_has_no_error_and_standing_adds_none() -> None:
    assert after(THERE_AND_BACK, Calibration(covariance=EXACTLY)) == pytest.approx((0.0,) * 6, abs=1e-18)
    assert after([(0.0, 0.0)] * 50) == (0.0,) * 6
