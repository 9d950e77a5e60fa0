"""The calibration's covariance, its root and the six robots that stand for it."""

import math

import msgspec
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from giraff_core.kinematics.calibration import Calibration, Covariance, Scales, cholesky
from tests.support.robots import DRIVE, ROBOT

entries = st.floats(-0.05, 0.05)  # a variance of three of them is below the largest that is taken


def covariance_of(rows: tuple[tuple[float, ...], ...]) -> Covariance:
    """L Lᵀ."""
    aa, ab, ac, bb, bc, cc = (
        sum(rows[i][k] * rows[j][k] for k in range(3)) for i, j in ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
    )
    return aa, ab, ac, bb, bc, cc


roots = st.tuples(*[st.tuples(entries, entries, entries)] * 3)


@given(roots)
def test_the_root_of_a_covariance_gives_it_back(rows: tuple[tuple[float, ...], ...]) -> None:
    covariance = covariance_of(rows)
    assert covariance_of(cholesky(covariance)) == pytest.approx(covariance, abs=1e-6)


@given(roots)
@example(((0.0390625, 0.0390625, 0.0), (0.04624478392973966, 0.04627269045501113, 0.0), (0.0, 0.03125, 0.0)))
def test_six_robots_have_mean_and_covariance_of_the_calibration(rows: tuple[tuple[float, ...], ...]) -> None:
    found = Calibration(left_wheel_scale=1.1, right_wheel_scale=0.9, track_scale=1.2, covariance=covariance_of(rows))
    points = found.sigma_points()
    off = [[a - b for a, b in zip(point, found.scales, strict=True)] for point in points]
    assert [sum(axis) for axis in zip(*off, strict=True)] == pytest.approx([0.0] * 3, abs=1e-12)
    spread = [sum(one[i] * one[j] for one in off) / 6 for i, j in ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))]
    assert spread == pytest.approx(found.covariance, abs=1e-6)


@pytest.mark.parametrize(
    "covariance",
    [
        (-1e-4, 0.0, 0.0, 1e-4, 0.0, 1e-4),
        (1e-4, 2e-4, 0.0, 1e-4, 0.0, 1e-4),
        (0.0, 1e-4, 0.0, 1e-4, 0.0, 1e-4),
        (1e-4, 0.0, 0.0, 1e-4, math.nan, 1e-4),
        (math.inf, 0.0, 0.0, 1e-4, 0.0, 1e-4),
    ],
    ids=["negative variance", "more than fully correlated", "correlated with what is known", "nan", "inf"],
)
def test_what_is_no_covariance_is_refused(covariance: Covariance) -> None:
    with pytest.raises(ValueError, match="covariance"):
        Calibration(covariance=covariance)


def test_a_covariance_of_whoever_knows_nothing_is_refused() -> None:
    with pytest.raises(ValueError, match="are these percentages, or deviations"):
        Calibration(covariance=(1e-4, 0.0, 0.0, 1e-4, 0.0, 0.018))


@pytest.mark.parametrize("values", [{"left_wheel_scale": 102.0}, {"track_scale": math.nan}, {"track_scale": 0.0}])
def test_a_scale_that_no_robot_has_is_refused(values: dict[str, float]) -> None:
    with pytest.raises(msgspec.ValidationError, match=r"_scale is .*: it must be within 0.5..2"):
        msgspec.convert(values, Calibration)


def test_a_robot_that_nobody_has_calibrated_is_as_built() -> None:
    assert Calibration().scales == Scales(1.0, 1.0, 1.0)
    assert ROBOT.left_ticks_per_metre == ROBOT.right_ticks_per_metre == ROBOT.ticks_per_metre
    assert ROBOT.kinematics.track_width == ROBOT.track_width


def test_a_larger_wheel_counts_less_a_metre_and_the_board_is_told() -> None:
    found = Calibration(left_wheel_scale=1.01, right_wheel_scale=0.98, track_scale=1.05)
    robot = msgspec.structs.replace(ROBOT, calibration=found)
    assert robot.left_ticks_per_metre == pytest.approx(ROBOT.ticks_per_metre / 1.01)
    assert robot.right_ticks_per_metre == pytest.approx(ROBOT.ticks_per_metre / 0.98)
    assert robot.kinematics.track_width == pytest.approx(1.05 * ROBOT.track_width)
    settings = DRIVE.board_settings(robot, 1.0)
    assert settings.left_counts_per_km == round(robot.left_ticks_per_metre * 1000)
    assert settings.right_counts_per_km == round(robot.right_ticks_per_metre * 1000)
