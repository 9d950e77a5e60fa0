"""Particles: how they move, what they make of what is heard, and how many there are."""

import math

import msgspec
import numpy as np
import pytest

from giraff_core.kinematics.calibration import EXACTLY, Calibration
from giraff_core.robot import RobotConfig
from giraff_localization.beams.range_table import BIN
from giraff_localization.beams.ultrasonic import Beam
from giraff_localization.cloud import Cloud
from giraff_localization.clusters import clusters
from giraff_localization.track import Stride
from tests.support.robots import ROBOT
from tests.unit.localization.rooms import floor

MIDDLE = (2.5, 1.5, 0.0)
CALIBRATED = msgspec.structs.replace(ROBOT, calibration=Calibration(covariance=EXACTLY))


STANDS = Stride(x=0.0, y=0.0, turn=0.0, forward=0.0, way=0.0, turned=0.0, missed=(0.0, 0.0))


def ahead(metres: float) -> Stride:
    return STANDS._replace(x=metres, forward=metres, way=abs(metres))


def cloud(pose: tuple[float, float, float] = MIDDLE, count: int = 4000, robot: RobotConfig = ROBOT) -> Cloud:
    poses = np.repeat(np.array(pose, np.float32)[:, None], count, 1)
    return Cloud(floor().space, robot, poses, np.random.default_rng(1))


def everywhere(count: int = 20_000) -> Cloud:
    random = np.random.default_rng(2)
    return Cloud(floor().space, ROBOT, floor().space.anywhere(count, random), random)


@pytest.mark.parametrize("metres", [1.0, -1.0])
def test_they_go_as_odometry_says(metres: float) -> None:
    moved = cloud((2.5, 1.5, math.pi / 2.0))
    moved.move(ahead(metres))
    assert moved.poses.mean(1) == pytest.approx((2.5, 1.5 + metres, math.pi / 2.0), abs=0.01)


def test_an_arc_ends_where_it_ends() -> None:
    moved = cloud()
    moved.move(STANDS._replace(x=0.3, y=0.1, turn=0.6, forward=0.33, way=0.33, turned=0.6))
    assert moved.poses.mean(1) == pytest.approx((2.8, 1.6, 0.6), abs=0.01)


def test_a_robot_that_nobody_has_calibrated_is_less_sure_of_its_way() -> None:
    spreads = []
    for robot in (ROBOT, CALIBRATED):
        moved = cloud(robot=robot)
        for _ in range(20):
            moved.move(ahead(0.1))
        spreads.append(moved.poses[2].std())
    assert spreads[0] > 2.0 * spreads[1]


def test_what_the_wheels_err_by_is_the_same_on_the_whole_way() -> None:
    """Twice the way is twice the error, not √2 of it."""
    moved = cloud()
    moved.move(ahead(1.0))
    once = moved.scales[1] - moved.scales[0]
    assert np.corrcoef(once, moved.poses[2])[0, 1] > 0.8


def test_what_odometry_has_missed_spreads_them() -> None:
    moved = cloud()
    moved.move(STANDS._replace(missed=(0.2, 0.35)))
    assert moved.poses.std(1) == pytest.approx((0.2, 0.2, 0.35), rel=0.1)


def test_a_robot_that_stands_stays() -> None:
    still = cloud()
    still.move(STANDS)
    assert still.poses.std(1) == pytest.approx((0.0, 0.0, 0.0))


def test_what_is_heard_tells_places_apart() -> None:
    """The wall ahead is 2 m away: so says who is 3 m from the west wall, and looks east."""
    heard = everywhere()
    beams = [Beam(0.0, 0.0, 0.0, round(2.0 / BIN), 1.0)]
    heard.weigh(beams, floor().sonars)
    x, _, yaw = heard.poses
    east = np.abs(np.remainder(yaw + math.pi, math.tau) - math.pi) < 0.2
    weights = heard.weights
    right, wrong = east & (np.abs(x - 3.0) < 0.1), east & (np.abs(x - 1.5) < 0.1)
    assert weights[right].mean() > 5.0 * weights[wrong].mean()


def test_evidence_is_of_all_particles_together() -> None:
    one, other = cloud(), cloud()
    one.weigh([Beam(0.0, 0.0, 0.0, round(2.5 / BIN), 1.0)], floor().sonars)
    other.weigh([Beam(0.0, 0.0, 0.0, round(1.0 / BIN), 1.0)], floor().sonars)
    assert one.evidence > other.evidence + 1.0


def test_half_a_gain_moves_weights_by_half_and_evidence_as_much() -> None:
    full, half = everywhere(), everywhere()
    half.gain = 0.5
    for each in (full, half):
        each.weigh([Beam(0.0, 0.0, 0.0, round(2.0 / BIN), 1.0)], floor().sonars)
    assert half.log_weights == pytest.approx(full.log_weights / 2.0)
    assert half.evidence == pytest.approx(full.evidence)


def test_they_are_drawn_anew_only_when_too_few_count() -> None:
    drawn = everywhere(1000)
    poses = drawn.poses
    drawn.resample(100, 1000)
    assert drawn.poses is poses
    drawn.log_weights[:] = -20.0
    drawn.log_weights[7] = 0.0
    drawn.resample(100, 1000)
    assert drawn.count < 200
    assert (drawn.poses == poses[:, 7:8]).all()


def test_low_variance_sampling_keeps_shares() -> None:
    drawn = cloud(count=10)
    drawn.poses[0] = np.arange(10)
    drawn.log_weights = np.log(np.array([0.5, 0.3, 0.2, *[1e-12] * 7]))
    drawn.draw(100)
    assert [int((drawn.poses[0] == each).sum()) for each in range(3)] == pytest.approx([50, 30, 20], abs=1)


def test_more_places_take_more_particles() -> None:
    wide, narrow = everywhere(), cloud()
    for each in (wide, narrow):
        each.log_weights = np.where(np.arange(each.count) % 4 == 0, 0.0, -50.0)
        each.resample(100, 20_000)
    assert wide.count > 5 * narrow.count


def test_a_mixture_has_its_shares() -> None:
    one, other = cloud((1.0, 1.5, 0.0), 1000), cloud((4.0, 1.5, 0.0), 400)
    one.join(other, 0.25)
    assert one.count == len(one.log_weights) == one.scales.shape[1] == 1000
    assert (one.poses[0] > 2.0).mean() == pytest.approx(0.25)


def test_scales_are_learned_from_those_who_know() -> None:
    taught, teacher = cloud(), cloud()
    teacher.scales[0] = 0.5
    taught.learn_scales(teacher)
    assert (taught.scales[0] == 0.5).mean() == pytest.approx(0.8, abs=0.05)


def test_a_sample_is_of_the_likely_and_no_larger_than_asked() -> None:
    shown = cloud(count=1000)
    shown.poses[0] = np.arange(1000)
    shown.log_weights = np.where(np.arange(1000) < 500, 0.0, -50.0)
    sample = shown.sample(300)
    assert sample.shape == (3, 300)
    assert sample[0].max() < 500
    assert cloud(count=5).sample(300).shape == (3, 5)


def test_clusters_are_found_heaviest_first() -> None:
    random = np.random.default_rng(3)
    places = [(1.0, 1.0, 3.1, 600), (4.0, 2.0, 0.5, 300), (2.5, 1.5, -2.0, 100)]
    parts = [np.array(place[:3])[:, None] + random.normal(0.0, 0.05, (3, place[3])) for place in places]
    gathered = Cloud(floor().space, ROBOT, np.hstack(parts).astype(np.float32), random)
    found = clusters(gathered)
    assert [each.mass for each in found] == pytest.approx([0.6, 0.3, 0.1])
    for each, place in zip(found, places, strict=True):
        assert each.pose[:2] == pytest.approx(place[:2], abs=0.02)
        assert abs(math.remainder(each.pose.yaw - place[2], math.tau)) < 0.02, "also about half a turn"
        assert each.spread == pytest.approx(0.05 * math.sqrt(2.0), rel=0.2)
        assert each.covariance[0] == pytest.approx(0.05**2, rel=0.4)


def test_one_place_with_two_headings_is_two() -> None:
    poses = np.array([[1.0] * 200, [1.0] * 200, [0.0] * 120 + [math.pi / 2.0] * 80], np.float32)
    found = clusters(Cloud(floor().space, ROBOT, poses, np.random.default_rng(4)))
    assert [each.mass for each in found] == pytest.approx([0.6, 0.4])
