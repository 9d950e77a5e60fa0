"""What is called within the ellipse of 95 %."""

import math

import pytest

from giraff_core.kinematics.pose import ELLIPSE_95, mahalanobis


def test_the_edge_is_that_of_chi_square() -> None:
    chi_square = ELLIPSE_95**2
    assert chi_square == pytest.approx(5.991, abs=1e-3)


@pytest.mark.parametrize("angle", [0.0, 0.7, math.pi / 2.0, 2.0])
def test_a_place_is_off_by_the_standard_deviations_along_each_axis(angle: float) -> None:
    cos, sin, long, short = math.cos(angle), math.sin(angle), 0.3, 0.1
    xx, yy = (long * cos) ** 2 + (short * sin) ** 2, (long * sin) ** 2 + (short * cos) ** 2
    xy = (long**2 - short**2) * cos * sin
    for along, aside, off in ((0.6, 0.0, 2.0), (0.0, 0.2, 2.0), (0.3, 0.1, math.sqrt(2.0)), (0.0, 0.0, 0.0)):
        x, y = along * cos - aside * sin, along * sin + aside * cos
        assert mahalanobis(x, y, xx, xy, yy) == pytest.approx(off, rel=1e-3)


def test_whoever_is_wholly_sure_is_off_by_more_than_a_count_only() -> None:
    assert mahalanobis(0.0005, 0.0, 0.0, 0.0, 0.0) < ELLIPSE_95 < mahalanobis(0.01, 0.0, 0.0, 0.0, 0.0)
    # Nearly singular: sure along one diagonal, not along the other.
    assert mahalanobis(1.0, 1.0, 1.0, 1.0, 1.0) == pytest.approx(1.0, rel=1e-3)
    assert mahalanobis(0.1, -0.1, 1.0, 1.0, 1.0) > 100.0
