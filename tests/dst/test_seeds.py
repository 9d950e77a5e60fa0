"""Seeds that between them reach everything: no invariant is violated, in runs that really drive and really go wrong."""

from __future__ import annotations

from typing import Final

import pytest

from giraff_sim.dst.drill import Outcome
from giraff_sim.dst.many import run_one
from giraff_sim.dst.marks import unreached
from giraff_sim.dst.scenarios import KINDS

DRAWN: Final[dict[int, tuple[str, ...]]] = {
    153: (
        "fault: replay",
        "fault: pause",
        "fault: disk",
        "fault: keyboard",
        "fault: deaf",
        "fault: person",
        "stop: slowed",
        "stop: no fresh command",
        "answer: stopped",
        "answer: the robot is stopped, and a restart may not know",
        "the joystick's button is pressed while the robot drives",
        "stop: emergency stop by button-N",
        "stop: the operator wishes so",
    ),
    212: (
        "fault: parameter",
        "fault: reset",
        "parameter: set",
        "parameter: refused",
        "parameter: saved",
        "fault: second joystick",
        "fault: kill",
        "stop: forward blocked",
        "stop: the base board is being configured",
    ),
    113: (
        "answer: released",
        "fault: two at the emergency stop",
        "fault: second guard",
        "answer: the emergency stop was engaged anew meanwhile",
        "fault: tilt sensor",
        "fault: suspend",
        "stop: the guard is not heard",
        "stop: a second guard",
    ),
    45: (
        "fault: wall clock",
        "fault: second base",
        "stop: a second base",
        "fault: disorder",
        "fault: battery",
        "stop: emergency stop by battery",
    ),
    111: (
        "stop: a range that this motion relies on is too old",
        "fault: sonar",
        "fault: obstacle",
        "fault: delay",
        "fault: unplug",
    ),
    167: (
        "fault: encoder",
        "the same engages the emergency stop anew",
        "stop: joystick",
        "answer: the emergency stop was engaged again after this reset was asked for",
        "stop: not armed since the left wheel was held",
    ),
    326: (
        "fault: slipping encoder",
        "fault: cut",
        "fault: loss",
        "stop: backward slowed",
        "stop: backward blocked",
    ),
    38: (
        "fault: full buffer",
        "answer: latch N is not the one engaged",
        "stop: /dev/giraff-base",
    ),
    20: (
        "stop: the guard's command is too old",
        "stop: forward slowed",
    ),
    249: (
        "fault: emergency stop",
        "answer: the reset is not from within the last",
    ),
    264: (
        "stop: the base board is in state command_timeout",
        "stop: not armed since a command or a range was stale for too long",
    ),
    64: ("answer: the disk hangs", "fault: flicker"),
    163: ("stop: a second ranger",),
    177: ("stop: another ranger",),
    375: ("stop: emergency stop by keyboard",),
}
"""Each is there for what it counts, which begins so. Where it no longer does, another seed does (`giraff dst`)."""
ONCE_FAILED: Final = (5031, 5640, 70098, 80504, 80657, 80958)
"""Robot or judge was wrong about them. Each still draws the faults of that time, and `make campaign` draws none."""
TOO_RARE: Final = [
    "stop: emergency stop by the base board",
    "an emergency stop was lost with its base",
    "parameter: not saved",
]
"""In none of the first 400 seeds; tests here stage the first two, `make campaign` draws two thousand."""
PATH: Final = 1.0
"""m that the robot drives in each that was drawn."""


@pytest.mark.parametrize("seed", DRAWN)
def test_no_invariant_is_violated(seed: int) -> None:
    outcome = run_one(seed)
    assert outcome.violations == ()
    assert outcome.path >= PATH
    assert never(outcome, "granted", "armed", *DRAWN[seed]) == []


@pytest.mark.parametrize("seed", ONCE_FAILED)
def test_what_once_failed_does_not_fail_again(seed: int) -> None:
    assert run_one(seed).violations == ()


def test_each_fault_stop_and_answer_is_what_some_seed_is_there_for() -> None:
    reached = dict.fromkeys((what for reasons in DRAWN.values() for what in reasons), 1)
    assert unreached(reached, KINDS) == TOO_RARE


def never(outcome: Outcome, *wanted: str) -> list[str]:
    """Of these beginnings of what a run counts, those that this one did not come to."""
    return [what for what in wanted if not any(counted.startswith(what) for counted in outcome.counts)]
