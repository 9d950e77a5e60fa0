"""What odometry claims of its error, and what a tape makes of a robot, of two hundred drawn ones."""

import statistics

import pytest

from giraff_core.kinematics.pose import ELLIPSE_95
from tests.support.report import report
from tests.unit.odometry.ellipses import PATHS, Path, held
from tests.unit.setup.drawn import calibrated

_ROBOTS = 200


@pytest.mark.parametrize("path", PATHS)
def test_the_ellipse_before_a_calibration(path: Path) -> None:
    found = held(path, range(_ROBOTS))
    report(f"campaign/ellipse_{path.__name__}", found._asdict())
    assert found.share >= 0.8


def test_a_calibration_by_tape_and_the_ellipse_after_it() -> None:
    outcomes = [calibrated(seed) for seed in range(_ROBOTS)]
    distances = [distance for each in outcomes for distance in each.distances]
    found = {
        "held": sum(distance <= ELLIPSE_95 for distance in distances) / len(distances),
        "line_area": statistics.fmean(each.areas[0] for each in outcomes),
        "wheel_rms": statistics.fmean(each.off[side] ** 2 for each in outcomes for side in (0, 1)) ** 0.5,
        "wheel_worst": max(abs(each.off[side]) for each in outcomes for side in (0, 1)),
        "track_rms": statistics.fmean(each.off[2] ** 2 for each in outcomes) ** 0.5,
        "track_worst": max(abs(each.off[2]) for each in outcomes),
    }
    report("campaign/calibration", found)
    assert 0.90 <= found["held"] <= 0.99
    assert found["track_worst"] <= 0.004
