"""What starts again, comes twice or flickers, with the hand held forward all the time: nothing moves."""

from random import Random

import pytest

from giraff_schemas.requests import EStopReset
from giraff_schemas.wire import BoardKind, ResetCause
from giraff_sim.dst.people import double
from giraff_sim.dst.simulated_run import Begin, Course, Outcome, SimulatedRun
from giraff_sim.record import MotorWindow
from giraff_sim.world.bno055 import Bno055Fault
from giraff_sim.world.hand import LEVEL
from tests.dst.courses import cut, engage, kill, replay, stop, unplug, watch
from tests.dst.stage import FORWARD, at, driving, level, stage

FAULT = 2.4  # s; the robot drives since 1.5
WATCHED = 2.0  # s; what arms by itself drives 1.7 s after each of these faults


def moves_nothing(fault: Begin, lasts: float, bound: float = 0.35, watched: float = WATCHED) -> Outcome:
    """That `fault` stops the robot within `bound`, s, and that nothing moves from then on."""
    verdicts: list[MotorWindow] = []
    outcome = stage(
        at(FAULT, fault, lasts),
        at(FAULT + bound, watch(verdicts), watched),
        seconds=FAULT + bound + watched + 0.1,
    )
    assert outcome.violations == ()
    assert outcome.path > 0.2, "it did not drive before"
    assert [verdict.driven_ms for verdict in verdicts] == [0]
    return outcome


def second(name: str) -> Begin:
    """Start another process of a service, on the same machine."""

    def course(run: SimulatedRun, chance: Random) -> Course:
        del chance
        run.loop.start(name, f"second {name}")
        yield f"a second {name} starts"
        run.loop.kill(f"second {name}")

    return course


def flickering(fault: Bno055Fault, on: float, off: float) -> Begin:
    """Let the tilt sensor fail and recover again and again, s."""

    def course(run: SimulatedRun, chance: Random) -> Course:
        del chance
        sensor, agenda = run.loop.simulation.bno055, run.loop.agenda
        assert sensor is not None
        moment = agenda.now_us
        for _ in range(round(WATCHED / (on + off))):
            agenda.at(moment, lambda: setattr(sensor, "fault", fault))
            agenda.at(moment + round(on * 1e6), lambda: setattr(sensor, "fault", Bno055Fault.NONE))
            moment += round((on + off) * 1e6)
        yield "the tilt sensor flickers"

    return course


def board_reset(cause: ResetCause) -> Begin:
    def course(run: SimulatedRun, chance: Random) -> Course:
        del chance
        run.loop.simulation.reset(BoardKind.BASE, cause)
        run.judge.on_reset(BoardKind.BASE)
        yield "the base board is reset"

    return course


@pytest.mark.parametrize("gap", [0.01, 0.3, 1.0])
@pytest.mark.parametrize("name", ["base", "guard"])
def test_a_restarted_service(name: str, gap: float) -> None:
    moves_nothing(kill(name), gap)


@pytest.mark.parametrize("cause", [ResetCause.POWER_ON, ResetCause.WATCHDOG, ResetCause.BROWN_OUT], ids=str)
def test_a_restarted_board(cause: ResetCause) -> None:
    moves_nothing(board_reset(cause), 0.0)


@pytest.mark.parametrize("gap", [0.05, 1.5])
def test_a_replugged_board(gap: float) -> None:
    moves_nothing(unplug("base"), gap)


@pytest.mark.parametrize(("name", "lasts"), [("guard", 3.0), ("base", 0.3), ("base", 3.0)])
def test_a_second_process(name: str, lasts: float) -> None:
    moves_nothing(second(name), lasts)


@pytest.mark.parametrize(
    ("fault", "on", "off"),
    [
        (Bno055Fault.ZERO, 0.1, 0.2),
        (Bno055Fault.FROZEN, 0.3, 0.1),
        (Bno055Fault.DEAD, 0.15, 0.5),
    ],
    ids=str,
)
def test_a_flickering_tilt_sensor(fault: Bno055Fault, on: float, off: float) -> None:
    moves_nothing(flickering(fault, on, off), 0.0, bound=0.45)


def test_a_ranger_that_was_missed_for_over_a_second() -> None:
    moves_nothing(unplug("ranger"), 1.3, bound=0.45)


def test_a_second_joystick_of_the_same_name() -> None:
    verdicts: list[MotorWindow] = []

    def another(run: SimulatedRun, chance: Random) -> Course:
        host = run.loop.hosts["operator"]
        run.loop.launch("second joystick", lambda process: double(process, chance, run.seconds), host)
        yield "a second joystick starts"

    outcome = stage(at(2.0, another), at(2.0, watch(verdicts), 9.0), hand=level(), seconds=11.5)
    assert outcome.violations == ()
    assert [verdict.driven_ms for verdict in verdicts] == [0]


def test_a_reset_that_comes_again_four_seconds_late() -> None:
    verdicts: list[MotorWindow] = []
    outcome = stage(
        at(2.5, stop, 0.3),
        at(5.0, engage),
        at(2.8 + 4.0, replay(EStopReset)),
        at(5.35, watch(verdicts), 3.0),
        hand=driving((2.6, LEVEL), (4.0, FORWARD), (6.0, LEVEL), (7.4, FORWARD)),
        seconds=8.4,
    )
    assert outcome.violations == ()
    assert outcome.counts["armed"] == 2, "the first reset did not release the robot"
    assert [verdict.driven_ms for verdict in verdicts] == [0]


def test_a_reset_that_comes_again_at_once_names_an_older_latch() -> None:
    verdicts: list[MotorWindow] = []
    outcome = stage(
        at(2.5, stop, 0.3),
        at(3.2, engage),
        at(3.4, replay(EStopReset)),
        at(3.55, watch(verdicts), 3.0),
        hand=driving((2.6, LEVEL), (5.0, FORWARD)),
        seconds=7.0,
    )
    assert outcome.violations == ()
    assert [verdict.driven_ms for verdict in verdicts] == [0]


def test_a_reset_that_tcp_held_for_four_seconds_clears_nothing() -> None:
    verdicts: list[MotorWindow] = []
    outcome = stage(
        at(2.5, stop, 1.6),  # reset at 4.1, on its way through a link that is cut
        at(4.0, cut("holds"), 4.0),
        at(2.85, watch(verdicts), 8.0),
        # The lease has ended meanwhile: a wish asks for it again, and level arms, were the robot released.
        hand=driving((2.6, LEVEL), (8.3, FORWARD), (8.6, LEVEL), (9.6, FORWARD)),
        seconds=11.0,
    )
    assert outcome.violations == ()
    assert "answer: the reset is not from within the last N s" in outcome.counts
    assert [verdict.driven_ms for verdict in verdicts] == [0]
