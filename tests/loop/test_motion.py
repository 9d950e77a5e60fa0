"""Motions through the whole robot, its firmware and its world, in simulated time."""

from __future__ import annotations

import math

import pytest

from giraff_sim.settings import Settings
from tests.loop.loops import BY_LEVELS, SETTINGS
from tests.loop.patterns import end_of_a_drawn_one, end_of_pattern
from tests.unit.motion.claims import CALIBRATED, NO_SLIP


@pytest.mark.parametrize("settings", [SETTINGS, BY_LEVELS], ids=["by speed", "by level"])
def test_the_pattern_of_an_exact_robot_ends_where_it_began(settings: Settings) -> None:
    end = end_of_pattern(settings)
    print(f"{end.off * 1000.0:.1f} mm and {math.degrees(end.turned):.2f}° off")
    assert end.off <= 0.01
    assert abs(end.turned) <= math.radians(0.5)


def test_the_pattern_of_a_drawn_one_ends_near_it_and_its_error_is_what_it_claims() -> None:
    end = end_of_a_drawn_one(CALIBRATED, NO_SLIP, seed=6)
    assert end.off <= 0.04
    assert abs(end.turned) <= math.radians(2.0)
    assert end.sigmas <= 3.0
