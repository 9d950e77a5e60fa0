"""What a motion claims of its error, of two hundred drawn robots before and after their calibration."""

import math
from collections.abc import Sequence

import pytest

from giraff_core.kinematics.calibration import Calibration
from giraff_schemas.motion import Arc, Move, Step, Turn
from giraff_sim.truth import NEVER_CALIBRATED, Level, TruthRanges
from tests.loop.patterns import end_of_a_drawn_one
from tests.support.report import report
from tests.unit.motion.claims import CALIBRATED, NO_SLIP, RANGES, share_held

_ROBOTS = 200
_WAYS: dict[str, Sequence[Step]] = {
    "move": (Move(distance=1.0),),
    "turn": (Turn(angle=math.pi),),
    "corner": (Move(distance=0.6), Turn(angle=math.pi / 2.0)),
    "bend": (Move(distance=0.5), Arc(radius=0.5, angle=math.pi / 2.0)),
}


@pytest.mark.parametrize("level", ["calibrated", "uncalibrated"])
@pytest.mark.parametrize("way", _WAYS)
def test_the_ellipsoid_of_a_motion(way: str, level: Level) -> None:
    held = share_held(_WAYS[way], level, range(_ROBOTS))
    report(f"campaign/motion_{way}_{level}", {"held": held})
    assert held >= 0.9


@pytest.mark.parametrize(
    ("calibration", "ranges"), [(CALIBRATED, NO_SLIP), (NEVER_CALIBRATED, RANGES)], ids=["no_slip", "slip"]
)
def test_the_pattern_of_drawn_robots(calibration: Calibration, ranges: TruthRanges) -> None:
    """One that slips in turns, and whose file does not know it, claims no more than it knows."""
    ends = [end_of_a_drawn_one(calibration, ranges, seed) for seed in range(20)]
    found = {
        "off_worst": max(end.off for end in ends),
        "turned_worst": math.degrees(max(abs(end.turned) for end in ends)),
        "sigmas_worst": max(end.sigmas for end in ends),
    }
    report(f"campaign/pattern_{'slips' if ranges.turn_slip else 'no_slip'}", found)
    assert found["sigmas_worst"] <= 3.0
    if not ranges.turn_slip:
        assert found["off_worst"] <= 0.04
        assert found["turned_worst"] <= 2.0
