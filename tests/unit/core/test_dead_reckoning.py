"""The arc and its uncertainty, against closed forms and against samples drawn at random."""

import math
import random
import statistics

import pytest
from hypothesis import given
from hypothesis import strategies as st

from giraff_core.kinematics.calibration import Covariance
from giraff_core.kinematics.dead_reckoning import REVERSAL, Estimate, advance
from giraff_core.kinematics.differential_drive import DifferentialDrive

TRACK = 0.47
DRIVE = DifferentialDrive(TRACK, max_wheel_speed=0.6)
NOISE = 1e-5
travel = st.floats(-2.0, 2.0)
starts = st.builds(Estimate, x=st.floats(-5.0, 5.0), y=st.floats(-5.0, 5.0), yaw=st.floats(-3.14, 3.14))
steps = st.lists(st.tuples(travel, travel), max_size=20)


def moved(start: Estimate, left: float, right: float) -> Estimate:
    return advance(start, left, right, DRIVE, NOISE)


def place(estimate: Estimate) -> tuple[float, float]:
    return estimate.x, estimate.y


def same_heading(one: float, other: float) -> bool:
    return abs(math.remainder(one - other, math.tau)) < 1e-9


def is_covariance(covariance: Covariance) -> bool:
    """Whether no combination of x, y and yaw has a negative variance (all principal minors, up to rounding)."""
    xx, xy, xt, yy, yt, tt = covariance
    minors = (xx, yy, tt, xx * yy - xy * xy, xx * tt - xt * xt, yy * tt - yt * yt)
    whole = xx * (yy * tt - yt * yt) - xy * (xy * tt - yt * xt) + xt * (xy * yt - yy * xt)
    return all(minor > -1e-9 for minor in (*minors, whole))


@given(starts, travel, travel)
def test_a_step_is_the_arc_about_its_centre(start: Estimate, left: float, right: float) -> None:
    """The closed form of textbooks, which fails where the wheels travel alike: there it is a straight line."""
    end = moved(start, left, right)
    turn = (right - left) / TRACK
    if abs(turn) > 1e-3:
        radius = (left + right) / 2.0 / turn
        x = start.x + radius * (math.sin(start.yaw + turn) - math.sin(start.yaw))
        y = start.y - radius * (math.cos(start.yaw + turn) - math.cos(start.yaw))
        assert place(end) == pytest.approx((x, y), abs=1e-9)
    assert same_heading(end.yaw, start.yaw + turn)


@given(starts, travel)
def test_wheels_that_travel_alike_go_straight(start: Estimate, distance: float) -> None:
    end = moved(start, distance, distance)
    expected = (start.x + distance * math.cos(start.yaw), start.y + distance * math.sin(start.yaw))
    assert place(end) == pytest.approx(expected)
    assert end.yaw == start.yaw


@given(starts, travel)
def test_opposite_wheels_turn_on_the_spot(start: Estimate, distance: float) -> None:
    end = moved(start, -distance, distance)
    assert place(end) == place(start)
    assert end.path == start.path
    assert same_heading(end.yaw, start.yaw + 2.0 * distance / TRACK)


@given(starts, travel)
def test_where_the_formula_changes_to_its_series_nothing_shows(start: Estimate, distance: float) -> None:
    less, more = (moved(start, distance, distance + TRACK * 2e-4 * near) for near in (0.999999, 1.000001))
    assert place(less) == pytest.approx(place(more), abs=1e-9)
    assert less.covariance == pytest.approx(more.covariance, abs=1e-12)


@given(starts, travel, travel, st.floats(0.0, 1.0))
def test_an_arc_in_two_parts_is_the_same_arc(start: Estimate, left: float, right: float, share: float) -> None:
    whole = moved(start, left, right)
    parts = moved(moved(start, left * share, right * share), left * (1.0 - share), right * (1.0 - share))
    assert place(parts) == pytest.approx(place(whole), abs=1e-9)
    assert same_heading(parts.yaw, whole.yaw)
    assert parts.path == pytest.approx(whole.path)


@given(starts, travel, travel)
def test_the_way_back_leads_back(start: Estimate, left: float, right: float) -> None:
    there = moved(start, left, right)
    back = moved(there, -left, -right)
    assert place(back) == pytest.approx(place(start), abs=1e-9)
    assert same_heading(back.yaw, start.yaw)


@pytest.mark.parametrize(
    ("way", "path"),
    [
        ([1.0], 1.0),
        ([-1.0], 1.0),
        ([0.5, -0.3, 0.2], 1.0),
        ([0.001, -0.001] * 500, 0.001),
        ([0.5, -0.009, 0.009, 0.5], 1.0),
        ([-0.006, -0.006], 0.012),
        ([0.5, -0.006, 0.001, -0.006, -0.5], 1.011),
        ([-0.5, 0.009, -0.009, -0.5], 1.0),
    ],
)
def test_path_counts_each_way_but_not_the_shaking_of_a_turn(way: list[float], path: float) -> None:
    estimate = Estimate()
    for distance in way:
        estimate = moved(estimate, distance - 0.01, distance + 0.01)
        assert 0.0 <= estimate.back <= REVERSAL
    assert estimate.path == pytest.approx(path)


@given(starts, steps)
def test_the_heading_stays_within_half_a_turn(start: Estimate, way: list[tuple[float, float]]) -> None:
    for left, right in way:
        start = moved(start, left, right)
        assert -math.pi < start.yaw <= math.pi


def test_half_a_turn_is_plus_pi_from_either_side() -> None:
    half = math.pi * TRACK / 2.0
    assert moved(Estimate(), -half, half).yaw == moved(Estimate(), half, -half).yaw == math.pi


@given(starts, steps)
def test_doubt_only_grows_and_stays_a_covariance(start: Estimate, way: list[tuple[float, float]]) -> None:
    for left, right in way:
        before, start = start.covariance, moved(start, left, right)
        assert is_covariance(start.covariance)
        assert start.covariance[5] >= before[5]


@given(st.floats(0.1, 2.0), st.floats(1.1, 3.0))
def test_doubt_grows_with_distance_and_with_turn(distance: float, factor: float) -> None:
    for side in (1.0, -1.0):  # straight on, and on the spot
        near, far = (moved(Estimate(), side * way, way).covariance for way in (distance, distance * factor))
        assert far[5] == pytest.approx(near[5] * factor)  # heading: each metre of wheel adds the same
        assert near[5] == pytest.approx(2.0 * NOISE * distance / TRACK**2)


def test_doubt_of_a_straight_line_in_small_steps_is_the_textbook_s() -> None:
    """Heading grows with the way, the side with its cube, along the way with itself."""
    estimate, length, count = Estimate(), 4.0, 4000
    for _ in range(count):
        estimate = moved(estimate, length / count, length / count)
    xx, xy, xt, yy, yt, tt = estimate.covariance
    per_metre = 2.0 * NOISE / TRACK**2  # of the heading
    assert tt == pytest.approx(per_metre * length)
    assert yt == pytest.approx(per_metre * length**2 / 2.0)
    assert yy == pytest.approx(per_metre * length**3 / 3.0, rel=1e-3)
    assert xx == pytest.approx(NOISE * length / 2.0)
    assert (xy, xt) == (0.0, 0.0)


def test_doubt_is_what_wheels_with_that_noise_really_do() -> None:
    """Thousands of robots whose wheels err at random, on a way with straights, bends and a turn on the spot."""
    way = [(0.02, 0.02)] * 25 + [(0.02, 0.012)] * 25 + [(-0.01, 0.01)] * 15 + [(-0.02, -0.02)] * 10
    noise, rng = 1e-4, random.Random(1)
    estimate = Estimate()
    for left, right in way:
        estimate = advance(estimate, left, right, DRIVE, noise)
    ends: list[tuple[float, float, float]] = []
    for _ in range(3000):
        x = y = yaw = 0.0
        for travels in way:
            left, right = (travel + rng.gauss(0.0, math.sqrt(noise * abs(travel))) for travel in travels)
            turn = (right - left) / TRACK
            x += (left + right) / 2.0 * math.cos(yaw + turn / 2.0)
            y += (left + right) / 2.0 * math.sin(yaw + turn / 2.0)
            yaw += turn
        ends.append((x, y, yaw))
    xs, ys, yaws = zip(*ends, strict=True)
    pairs = [(xs, xs), (xs, ys), (xs, yaws), (ys, ys), (ys, yaws), (yaws, yaws)]
    scales = [math.sqrt(statistics.variance(a) * statistics.variance(b)) for a, b in pairs]
    for (a, b), scale, variance in zip(pairs, scales, estimate.covariance, strict=True):
        assert statistics.covariance(a, b) == pytest.approx(variance, abs=0.1 * scale)
