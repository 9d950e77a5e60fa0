"""The fixed seeds: no invariant is violated, in runs that really drive and really go wrong."""

from __future__ import annotations

import os
import time
from typing import Final

import pytest

from giraff_sim.dst.drill import KINDS, SECONDS
from giraff_sim.dst.many import Totals, run_many

ONCE_FAILED: Final = (1451, 1922, 1928, 2267, 2616, 2885, 2995, 3056, 3263, 4952, 4966, 5031, 5640, 5796)
"""Robot or judge was wrong about them."""
SEEDS: Final = (*range(100), *ONCE_FAILED)
PER_SEED = {
    "armed": 1.2,
    "stop: the operator wishes so": 1.0,
    "stop: forward blocked": 0.2,
    "stop: joystick": 0.1,
    "stop: emergency stop by button-N": 0.05,
    "stop: the guard is not heard": 0.03,
    "stop: no fresh command of an operator": 0.05,
}
"""How often, at the least, for each seed."""


def processors() -> int:
    """Those that are this test's: other tests may have a process on each of the rest."""
    return max(1, (os.cpu_count() or 1) // int(os.environ.get("PYTEST_XDIST_WORKER_COUNT", "1")))


@pytest.mark.timeout(3600)  # it takes what other tests leave of the machine
def test_no_invariant_is_violated() -> None:
    totals = Totals()
    began = time.monotonic()
    for outcome in run_many(SEEDS, processors()):
        totals.take(outcome, SECONDS)
    seconds = time.monotonic() - began
    seeds = len(SEEDS)
    print(
        f"{seeds} seeds in {seconds:.0f} s, {totals.simulated / seconds:.0f} times as fast as real; "
        f"{totals.path:.0f} m driven, {totals.contacts} contacts; digest {totals.digest[:16]}"
    )
    assert {failure.seed: failure.violations for failure in totals.failures} == {}
    assert totals.drove >= 0.9 * seeds
    assert totals.path >= 1.2 * seeds
    rare = {what: totals.counts[what] for what, least in PER_SEED.items() if totals.counts[what] < least * seeds}
    assert rare == {}
    never = [kind.name for kind in KINDS if totals.counts[f"fault: {kind.name}"] < 0.02 * seeds]
    assert never == []
