"""A hundred approaches to a wall, and many by an arc, in simulated time."""

import pytest

from tests.loop.approaches import OF_USE, approach, curve_before_a_smooth_wall

APPROACHES = 100


@pytest.mark.timeout(1200)
def test_a_hundred_approaches_stop_outside_the_margin() -> None:
    rests = [approach(number) for number in range(APPROACHES)]
    print(f"{APPROACHES} approaches: at rest {min(rests):.3f} to {max(rests):.3f} m from the wall")
    assert max(rests) < OF_USE


@pytest.mark.parametrize("side", [1.0, -1.0], ids=["forward", "backward"])
@pytest.mark.parametrize("distance", [1.5, 1.8, 2.1, 2.4])
@pytest.mark.parametrize("loses_at", [0.55, 0.7, 0.9, 1.3])
def test_a_robot_that_curves_stops_before_a_wall_that_it_no_longer_hears(
    monkeypatch: pytest.MonkeyPatch, distance: float, side: float, loses_at: float
) -> None:
    curve_before_a_smooth_wall(monkeypatch, distance, loses_at, side)
