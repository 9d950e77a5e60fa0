"""What a motion says of its own error holds it."""

import math

import pytest

from giraff_schemas.motion import MotionMove, MotionTurn, Move, Turn
from tests.unit.motion.bench import Bench
from tests.unit.motion.claims import CALIBRATED, share_held


def test_what_it_claims_holds_its_error() -> None:
    held = share_held((Move(distance=0.6), Turn(angle=math.pi / 2.0)), "calibrated", range(50))
    print(f"{held:.0%} of 50 robots end within the ellipsoid of 95 %")
    assert 0.90 <= held <= 0.99


def test_it_claims_what_has_come_to_it_on_this_way_alone() -> None:
    """Not what odometry has missed before."""
    bench = Bench(calibration=CALIBRATED)
    first = bench.do(MotionMove, distance=0.5)
    bench.do(MotionTurn, angle=2.0)
    last = bench.do(MotionMove, distance=0.5)
    assert last.standard_deviations == pytest.approx(first.standard_deviations, rel=0.1)
    turned = bench.do(MotionTurn, angle=2.0)
    track = math.sqrt(CALIBRATED.covariance[5])
    assert turned.standard_deviations[2] == pytest.approx(2.0 * track, rel=0.3)
