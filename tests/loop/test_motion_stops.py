"""Rows of the fault table while a motion moves the robot, in simulated time: the motors' record is the judge."""

from collections.abc import Callable
from functools import partial
from typing import Final, NamedTuple

import pytest

from giraff_motion.goal import Goal
from giraff_motion.policy import MotionPolicy
from giraff_motion.service import Motion
from giraff_schemas.motion import MotionMove, Outcome
from giraff_schemas.trouble import Trouble
from giraff_sim.settings import Services
from tests.loop.motions import AHEAD, Stage, stage

ROBOT_SIDE: Final = 0.35
OPERATORS: Final = 0.45
"""s to PWM 0, as `tests/timing/faults.py` has it."""
UNDER_WAY: Final = 0.4
"""s for which it has moved when the fault comes."""
LASTS: Final = 1.3
AFTER: Final = 0.6
"""s after the end of the fault in which nothing may be driven."""
ANEW: Final = 1.2
"""s after which base or guard, which has begun anew, lets anybody drive."""


class Row(NamedTuple):
    """A fault, how it is mended, and what then becomes of the motion."""

    bound: float
    begin: Callable[[Stage], object]
    mend: Callable[[Stage], object] = lambda _: None
    outcome: Outcome = ""
    """Empty: giraff_motion is not there to tell."""


def kill(name: str) -> Callable[[Stage], object]:
    return lambda it: it.loop.kill(name)


def end(name: str) -> Callable[[Stage], object]:
    return lambda it: it.loop.terminate(name)


def start(name: str) -> Callable[[Stage], object]:
    return lambda it: it.loop.start(name)


def pause(name: str) -> Callable[[Stage], object]:
    def act(it: Stage) -> None:
        it.loop.processes[name].paused = True

    return act


def go_on(name: str) -> Callable[[Stage], object]:
    def act(it: Stage) -> None:
        process = it.loop.processes[name]
        process.paused = False
        process.go_on()

    return act


def cut(how: str) -> Callable[[Stage], object]:
    def act(it: Stage) -> None:
        for link in it.links:
            link.cut = how

    return act


def mend(it: Stage) -> None:
    for link in it.links:
        it.network.mend(link)


def delay(seconds: float) -> Callable[[Stage], object]:
    def act(it: Stage) -> None:
        for link in it.links:
            link.delay_us = round(seconds * 1e6)

    return act


ROWS: Final = {
    "requester killed": Row(OPERATORS, kill("requester"), Stage.start_requester, "lost_requester"),
    "requester suspended": Row(OPERATORS, pause("requester"), go_on("requester"), "lost_requester"),
    "link cut": Row(OPERATORS, cut("holds"), mend, "lost_requester"),
    "link delayed by 0.5 s": Row(OPERATORS, delay(0.5), delay(0.01), "lost_requester"),
    "motion killed": Row(OPERATORS, kill("motion"), start("motion")),
    "motion ended": Row(OPERATORS, end("motion"), start("motion")),
    "motion suspended": Row(OPERATORS, pause("motion"), go_on("motion"), "lost_lease"),
    "odometry killed": Row(OPERATORS, kill("odometry"), start("odometry"), "lost_odometry"),
    "odometry suspended": Row(OPERATORS, pause("odometry"), go_on("odometry"), "lost_odometry"),
    "base killed": Row(ROBOT_SIDE, kill("base"), start("base"), "disarmed"),
    "guard killed": Row(ROBOT_SIDE, kill("guard"), start("guard"), "disarmed"),
    "ranger killed": Row(OPERATORS, kill("ranger"), start("ranger"), "blocked"),
}
"""By the names of docs/safety.md, where it moves."""
LOSSY: Final = {"link that loses all": Row(OPERATORS, cut("loses"), mend, "lost_requester")}


@pytest.mark.parametrize("name", [*ROWS, *LOSSY])
def test_a_fault_stops_a_motion_within_its_bound(name: str) -> None:
    """And it is over: what comes back moves nothing, until somebody asks anew."""
    row = (ROWS | LOSSY)[name]
    with stage() as it:
        it.begin(MotionMove, **AHEAD)
        it.run(UNDER_WAY)
        assert it.driven_ms(it.now - 0.1) > 90, "it did not move before"
        fault = it.now
        row.begin(it)
        it.run(LASTS)
        row.mend(it)
        it.run(ANEW if name in {"base killed", "guard killed"} else AFTER)
        assert it.last_driven(fault) <= row.bound
        assert it.last_driven(fault + row.bound) == 0.0
        if row.outcome:
            assert (it.state.stage, it.state.outcome) == ("ended", row.outcome), it.state.reason
            assert it.state.reason
        it.begin(MotionMove, **AHEAD)


class Deaf(MotionPolicy):
    """It does not notice that nobody holds."""

    def _requester_fault(self, motion: Goal, now: float) -> tuple[Outcome, Trouble] | None:
        del motion, now
        return None


def test_the_robots_time_that_the_requester_has_heard_stops_it_by_itself() -> None:
    """What giraff_motion says goes by it, so that nothing need be noticed there."""
    with stage(services=Services(motion=partial(Motion, policy=Deaf))) as it:
        it.begin(MotionMove, **AHEAD)
        it.run(UNDER_WAY)
        fault = it.now
        ROWS["requester suspended"].begin(it)
        it.run(1.0)
        assert it.last_driven(fault) <= OPERATORS
        assert it.driven_ms(fault + OPERATORS) == 0


def test_a_requester_that_is_late_by_less_moves_it_on() -> None:
    with stage() as it:
        delay(0.06)(it)
        it.begin(MotionMove, **AHEAD)
        it.run(1.0)
        assert it.driven_ms(it.now - 0.5) > 490
