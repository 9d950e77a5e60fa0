"""Motions through the whole robot, its firmware and its world, in simulated time."""

import math

from giraff_schemas.motion import Move, Turn
from tests.loop.loops import BY_LEVELS
from tests.loop.patterns import end_of_a_drawn_one, end_of_pattern
from tests.unit.motion.claims import CALIBRATED, NO_SLIP


def test_the_pattern_of_an_exact_robot_ends_where_it_began() -> None:
    """By levels, which the robot's own hold of a speed does not help; that of a drawn robot goes by speed, and 2 m."""
    there, back = Move(distance=0.8), Turn(angle=math.pi)
    end = end_of_pattern(BY_LEVELS, steps=(there, back, there, Turn(angle=-math.pi)))
    print(f"{end.off * 1000.0:.1f} mm and {math.degrees(end.turned):.2f}° off")
    assert end.off <= 0.01
    assert abs(end.turned) <= math.radians(0.5)


def test_the_pattern_of_a_drawn_one_ends_near_it_and_its_error_is_what_it_claims() -> None:
    end = end_of_a_drawn_one(CALIBRATED, NO_SLIP, seed=6)
    assert end.off <= 0.04
    assert abs(end.turned) <= math.radians(2.0)
    assert end.sigmas <= 3.0
