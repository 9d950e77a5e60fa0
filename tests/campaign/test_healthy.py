"""Healthy robots whose boards must not stop them: more seeds than tests/sim has."""

import pytest

from giraff_sim.board import Implementation
from tests.sim.test_base_faults import ask_whatever
from tests.sim.test_speed import ask_in_turn, start_healthily
from tests.sim.test_speed_boards import drive_on_either


@pytest.mark.parametrize("seed", range(20))
def test_no_healthy_robot_is_stopped(seed: int) -> None:
    start_healthily(seed)
    ask_in_turn(seed)
    for implementation in Implementation:
        ask_whatever(implementation, seed)
    drive_on_either(seed)
