"""How much a place explains."""

import pytest

from giraff_core.kinematics.pose import Pose
from giraff_localization.beams.range_table import BIN, CLEAR
from giraff_localization.beams.ultrasonic import Beam
from giraff_localization.fit import Counts, Fit, compare
from tests.unit.localization.rooms import floor

HERE = Pose(2.475, 1.525, 0.0)


def beam(distance: float | None, yaw: float = 0.0) -> Beam:
    return Beam(0.0, 0.0, yaw, CLEAR if distance is None else round(distance / BIN), 1.0)


@pytest.mark.parametrize(
    ("distance", "counts"),
    [
        (2.5, (1.0, 0.0, 1.0)),
        (2.7, (1.0, 0.0, 1.0)),
        (3.5, (0.0, 0.0, 1.0)),
        (1.0, (0.0, 1.0, 1.0)),
        (None, (0.0, 0.0, 1.0)),
    ],
)
def test_a_reading_fits_or_is_nearer_or_does_not(distance: float | None, counts: tuple[float, float, float]) -> None:
    assert compare(floor(), HERE, [beam(distance)]) == counts


def test_what_is_too_slanted_says_nothing() -> None:
    assert compare(floor(), HERE, [beam(1.0, yaw=0.6)]) == (0.0, 0.0, 0.0)


def test_in_a_wall_nothing_fits() -> None:
    assert compare(floor(), Pose(0.05, 1.5, 0.0), [beam(None), beam(1.0, yaw=0.6)]) == (0.0, 0.0, 2.0)


def test_of_nothing_heard_nothing_is_counted() -> None:
    assert compare(floor(), HERE, []) == (0.0, 0.0, 0.0)
    assert (Fit().share, Fit().forgiving) == (0.0, 0.0)


def test_what_is_nearer_counts_little_against_a_place() -> None:
    fit = Fit()
    fit.add(Counts(2.0, 1.0, 3.0), 0.1)
    assert fit.share == pytest.approx(2.0 / 3.0)
    assert fit.forgiving == pytest.approx(2.0 / 2.3)


def test_a_place_that_explains_nearly_nothing_explains_nothing() -> None:
    fit = Fit()
    fit.add(Counts(1.0, 9.0, 10.0), 0.1)
    assert fit.forgiving == 0.0


def test_it_forgets() -> None:
    fit = Fit()
    fit.add(Counts(10.0, 0.0, 10.0), 0.1)
    for _ in range(200):
        fit.add(Counts(0.0, 0.0, 0.1), 0.1)
    assert fit.share < 0.05
