"""Faults of a robot with a RoboClaw: of the process in the place of its base board, and of the controller behind it."""

from typing import Final, NamedTuple

import pytest

from giraff_sim.dst.faults.robot import CONTROLLER_FAULTS, controller_fault
from giraff_sim.dst.scenarios import draw
from giraff_sim.dst.simulated_run import Begin, Outcome, play
from giraff_sim.record import MotorWindow
from giraff_sim.truth import draw_truth
from tests.dst.courses import block_wheel, kill, watch
from tests.dst.stage import at, stage
from tests.support.robot_files import ROBOTS

ROBOCLAW: Final = ROBOTS["roboclaw"]
FAULT: Final = 1.9
"""s; the robot drives for a third of a second by then."""
WATCHED: Final = 1.2
"""s after the end of the fault, while the hand is as it was."""
STEP: Final = 0.008
"""s of the simulation, at both ends."""


class Row(NamedTuple):
    """A fault that lasts so many s, and within what time, s, no motor gets anything any more."""

    bound: float
    begin: Begin
    lasts: float


def _of(what: str) -> Begin:
    [whole] = [each for each in CONTROLLER_FAULTS if what in each]
    return controller_fault(whole)


ROWS: Final = {
    "base killed": Row(0.31, kill("base"), 0.3),
    "guard killed": Row(0.19, kill("guard"), 0.3),
    "board killed": Row(0.20, _of("killed"), 0.3),
    "board suspended": Row(0.20, _of("suspended"), 3.0),
    "board hangs": Row(0.20, _of("hangs"), 0.4),
    "wires off": Row(0.20, _of("cut"), 0.4),
    "adapter holds all bytes": Row(0.20, _of("holds up"), 1.0),
    "controller without power": Row(0.02, _of("no power"), 0.008),
    "controller's emergency input": Row(0.005, _of("emergency input"), 0.4),
    "left wheel blocked": Row(0.35, block_wheel(0), 0.4),
}
"""By the names of docs/safety.md."""


def driven_until(row: Row, seed: int) -> tuple[float, Outcome]:
    """Return the time from its fault, s, until a motor of a drawn robot gets something for the last time."""
    before: list[MotorWindow] = []
    after: list[MotorWindow] = []
    watched = row.lasts + WATCHED
    outcome = stage(
        at(FAULT - 0.1, watch(before), 0.1),
        at(FAULT, row.begin, row.lasts),
        at(FAULT, watch(after), watched),
        settings=ROBOCLAW.settings,
        sim=ROBOCLAW.sim,
        truth=draw_truth("uncalibrated", ROBOCLAW.sim.truth, seed),
        seconds=FAULT + watched + 0.02,
    )
    assert outcome.violations == ()
    assert before[0].driven_ms > 90, "it did not drive before"
    return ((after[0].last_driven_us or after[0].since_us) - after[0].since_us) * 1e-6, outcome


def require_stopped(name: str, seed: int) -> float:
    """Fail where a fault stops a drawn robot too late, or it drives again without a hand that is level."""
    seconds, _ = driven_until(ROWS[name], seed)
    assert seconds <= ROWS[name].bound + STEP
    return seconds


@pytest.mark.parametrize("name", ROWS)
def test_a_fault_stops_it_within_its_bound_and_nothing_drives_afterwards(name: str) -> None:
    require_stopped(name, 1)


def test_a_tenth_of_a_second_without_the_process_is_none_of_them() -> None:
    seconds, outcome = driven_until(Row(0.0, _of("suspended"), 0.1), 1)
    assert seconds == pytest.approx(0.1 + WATCHED, abs=STEP)
    assert outcome.counts["armed"] == 1


def played(seed: int) -> Outcome:
    """Return what the drawn faults of a seed do to it."""
    return play(draw(seed), ROBOCLAW.settings, sim=ROBOCLAW.sim)


def test_a_seed_with_the_loss_of_its_controller_violates_nothing() -> None:
    """It also begins to drive again."""
    outcome = play(draw(95)._replace(seconds=6.5), ROBOCLAW.settings, sim=ROBOCLAW.sim)
    assert outcome.violations == ()
    assert (outcome.counts["fault: controller"], outcome.counts["armed"]) == (1, 2)
