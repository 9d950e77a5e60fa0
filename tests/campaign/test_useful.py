"""How useful the robot is: what a change of the guard must not take from it."""

from tests.loop.useful import DEMO_SPEED, HALL_S, PASSED_S, RELEASE_MEDIAN_S, RELEASE_S, figures
from tests.support.report import report


def test_useful() -> None:
    found = figures()
    report("campaign/useful", found)
    assert found["hall_max_s"] <= HALL_S
    assert found["passed_in_the_open_max_s"] <= PASSED_S
    assert found["passed_before_a_wall_max_s"] <= PASSED_S
    assert found["moves_before_a_wall_median_s"] <= RELEASE_MEDIAN_S
    assert found["moves_before_a_wall_max_s"] <= RELEASE_S
    assert found["demonstration_m_s"] >= 0.95 * DEMO_SPEED
    assert found["contacts"] == 0
