"""Faults of Ardros, whose motor driver obeys a servo pulse: up to 22 ms later than an H bridge obeys PWM."""

from typing import Final

import pytest

from giraff_sim.dst.scenarios import draw
from giraff_sim.dst.simulated_run import Outcome, play
from tests.dst.courses import cut_signal
from tests.dst.test_stops import ROWS as STOCK
from tests.dst.test_stops import Row, driven_ms
from tests.support.robot_files import ARDROS

LATER: Final = 0.022
"""s."""
SAME: Final = (
    "base suspended",
    "joystick suspended",
    "base board reset (external)",
    "right encoder cut",
    "left wheel blocked",
    "e-stop engaged",
)

ROWS: Final = {
    **{name: STOCK[name]._replace(bound=STOCK[name].bound + LATER) for name in SAME},
    "both signal wires cut": Row(0.12, (cut_signal(0, 1),)),
    "left signal wire cut": Row(0.35 + LATER, (cut_signal(0),)),
}
"""By the names of docs/safety.md."""


@pytest.mark.parametrize("name", ROWS)
def test_a_fault_stops_ardros_within_its_bound(name: str) -> None:
    assert driven_ms(ROWS[name], settings=ARDROS.settings, sim=ARDROS.sim) == 0


def played(seed: int) -> Outcome:
    """Return what the drawn faults of a seed do to it."""
    return play(draw(seed), ARDROS.settings, sim=ARDROS.sim)


def test_a_reset_in_the_midst_of_a_pulse_is_no_violation() -> None:
    """The motor driver takes the piece of a pulse for full speed backward, until the next pulse."""
    assert play(draw(10)._replace(seconds=5.0), ARDROS.settings, sim=ARDROS.sim).violations == ()
