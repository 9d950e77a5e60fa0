"""What a tape finds of robots that nobody has calibrated."""

import math
from typing import Final

import numpy as np

from giraff_core.kinematics.pose import ELLIPSE_95
from giraff_setup.wheels.odometry.plan import PLAN
from giraff_sim.truth import TruthRanges
from tests.unit.setup.drawn import calibrated

_ROBOTS: Final = 6
_WANTED: Final = np.array((0.002, 0.002, 0.004))
"""Of the left wheel, the right wheel and the track."""


def test_wheels_and_track_are_found_as_well_as_a_tape_allows_and_odometry_then_knows_its_error() -> None:
    outcomes = [calibrated(seed) for seed in range(_ROBOTS)]
    off, sd = np.abs(np.array([each.off for each in outcomes])), np.array([each.sd for each in outcomes])
    rms = np.sqrt(np.mean(off**2, axis=0))
    for name, each, root, spread in zip(("left", "right", "track"), off.T, rms, sd.T, strict=True):
        print(f"{name}: worst {np.max(each):.3%}, rms {root:.3%}, predicted {np.mean(spread):.3%}")
    assert np.all(off < 3.0 * sd)
    assert np.all(rms < 1.3 * np.mean(sd, axis=0))
    assert np.all(off <= _WANTED)
    distances = np.array([each.distances for each in outcomes])
    held, middle = np.mean(distances <= ELLIPSE_95), np.median(distances)
    print(f"the ellipse of 95 % holds {held:.1%} of {distances.size}; half of them are within {middle:.2f} deviations")
    assert held >= 0.9
    assert 0.6 < middle < 1.6, "of the right size 1.18"


def test_odometry_tells_whole_turns_apart_even_of_a_robot_that_differs_more_than_any_is_drawn() -> None:
    ranges, more = TruthRanges(), 0.05
    most = max(max(map(abs, leg.turned)) for leg in PLAN)
    factors = (
        (1.0 + ranges.wheel_scale) / (1.0 - ranges.track_scale),
        (1.0 - ranges.wheel_scale) / (1.0 + ranges.track_scale) * (1.0 - ranges.turn_slip),
    )
    assert all(most * (abs(factor - 1.0) + more) < math.pi for factor in factors)
