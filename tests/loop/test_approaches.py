"""Driving at a wall: never touches, stops outside the margin, and can always get away.

A part of what `tests/campaign/test_approaches.py` does.
"""

from __future__ import annotations

import pytest

from tests.loop.approaches import OF_USE, approach, curve_before_a_smooth_wall

APPROACHES = {
    0: "backward from afar, slanted by 17 degrees",
    2: "backward, slowly, from 2.9 m: rests nearest of all",
    15: "backward, the shortest way, slanted the most",
    91: "backward, slanted to the other side",
    31: "slanted the most",
    52: "slanted the most to the other side, a short way",
    34: "straight",
    36: "from 3 m, at full speed",
    66: "rests farthest off",
}
"""By seed: of the hundred, those at the ends of incidence and distance, and those that rest nearest and farthest."""


@pytest.mark.parametrize("number", APPROACHES)
def test_an_approach_stops_outside_the_margin(number: int) -> None:
    assert approach(number) < OF_USE


@pytest.mark.parametrize(
    ("distance", "loses_at", "side"),
    [(1.5, 1.3, 1.0), (2.1, 0.9, 1.0), (2.4, 0.55, 1.0), (1.5, 0.55, -1.0), (2.1, 1.3, -1.0), (2.4, 0.7, -1.0)],
)
def test_a_robot_that_curves_stops_before_a_wall_that_it_no_longer_hears(
    monkeypatch: pytest.MonkeyPatch, distance: float, loses_at: float, side: float
) -> None:
    """Forward (`side` 1) and backward, among them those that come nearest."""
    curve_before_a_smooth_wall(monkeypatch, distance, loses_at, side)
