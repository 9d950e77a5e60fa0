"""Each fault of a laser scanner stops the robot, or slows it to a creep, soon enough."""

import pytest

from tests.loop.scan_faults import BOUND, CREEP, FAULTS, react


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_of_the_scanner_stops_the_robot_or_slows_it(name: str) -> None:
    reaction = react(name, seed=1, after=0.5)
    assert reaction.steady > CREEP, "it was slow before"
    assert reaction.blind == 0
    assert reaction.seconds <= BOUND
