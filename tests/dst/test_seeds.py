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
    214: (
        "fault: wall clock",
        "fault: parameter",
        "fault: reset",
        "fault: emergency stop",
        "answer: released",
        "parameter: set",
        "parameter: refused",
        "parameter: saved",
    ),
    167: (
        "fault: second joystick",
        "fault: encoder",
        "fault: two at the emergency stop",
        "stop: emergency stop by the base board",
        "the same engages the emergency stop anew",
        "stop: joystick",
    ),
    218: (
        "fault: kill",
        "fault: second guard",
        "fault: full buffer",
        "stop: a range that this motion relies on is too old",
        "answer: the emergency stop was engaged anew meanwhile",
    ),
    249: (
        "fault: second base",
        "fault: tilt sensor",
        "stop: a second base",
        "answer: the reset is not from within the last",
    ),
    173: ("fault: cut", "fault: sonar", "stop: forward blocked"),
    229: ("fault: loss", "fault: suspend", "stop: the guard is not heard"),
    183: ("fault: disorder", "stop: the base board is in state command_timeout"),
    20: ("stop: the guard's command is too old",),
    123: ("fault: obstacle",),
    111: ("fault: delay", "fault: unplug"),
    364: ("answer: latch N is not the one engaged",),
    312: ("stop: forward slowed",),
    64: ("answer: the disk hangs",),
    19: ("fault: battery", "stop: a second guard"),
    216: ("stop: the battery is empty",),
    163: ("stop: a second ranger",),
    177: ("stop: another ranger",),
    375: ("stop: emergency stop by keyboard",),
    75: (
        "stop: not armed since a command or a range was stale for too long",
        "stop: the base board is being configured",
    ),
    275: (
        "stop: /dev/giraff-base",
        "answer: the emergency stop was engaged again after this reset was asked for",
    ),
    90: ("stop: backward slowed",),
    318: ("stop: backward blocked",),
    **dict.fromkeys((38, 77, 113, 212), ()),
}
"""Each is there for what it counts, which begins so. Where it no longer does, another seed does (`giraff dst`)."""
ONCE_FAILED: Final = (
    *(1451, 1922, 1928, 2267, 2616, 2885, 2995, 3056, 3263, 4952, 4966, 5031, 5640, 5796),
    *(70098, 80504, 80657, 80958),
)
"""Robot or judge was wrong about them."""
TOO_RARE: Final = ["an emergency stop was lost with its base", "parameter: not saved"]
"""In none of the first 400 seeds; `test_judge.py` stages the one, `make campaign` draws two thousand."""
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
