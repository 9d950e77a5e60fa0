"""Driving at a wall: never touches, stops outside the margin, and can always get away.

A part of what `tests/campaign/test_approaches.py` does.
"""

import pytest

from tests.loop.approaches import OF_USE, approach, curve_before_a_smooth_wall

APPROACHES = {
    15: "backward, the shortest way, slanted the most",
    66: "rests farthest off",
}
"""By seed."""


@pytest.mark.parametrize("number", APPROACHES)
def test_an_approach_stops_outside_the_margin(number: int) -> None:
    assert approach(number) < OF_USE


@pytest.mark.parametrize(("distance", "loses_at", "side"), [(2.1, 0.9, 1.0), (2.1, 1.3, -1.0)])
def test_a_robot_that_curves_stops_before_a_wall_that_it_no_longer_hears(
    monkeypatch: pytest.MonkeyPatch, distance: float, loses_at: float, side: float
) -> None:
    """Those that come nearest, forward (`side` 1) and backward."""
    curve_before_a_smooth_wall(monkeypatch, distance, loses_at, side)
