"""The fixed seeds: no invariant is violated, in runs that really drive and really go wrong."""

from __future__ import annotations

import os
import time

import pytest

from giraff_sim.dst.drill import KINDS, SECONDS
from giraff_sim.dst.many import Totals, run_many

SEEDS = 500
PER_SEED = {
    "armed": 1.2,
    "stop: the operator wishes so": 1.0,
    "stop: forward blocked": 0.2,
    "stop: joystick": 0.1,
    "stop: emergency stop by button": 0.05,
    "stop: the guard is not heard": 0.03,
    "stop: no fresh command of joystick": 0.05,
}
"""How often, at the least, for each seed."""


@pytest.mark.timeout(3600)  # it takes what other tests leave of the machine
def test_no_invariant_is_violated() -> None:
    totals = Totals()
    began = time.monotonic()
    for outcome in run_many(range(SEEDS), os.cpu_count() or 1):
        totals.take(outcome, SECONDS)
    seconds = time.monotonic() - began
    print(
        f"{SEEDS} seeds in {seconds:.0f} s, {totals.simulated / seconds:.0f} times as fast as real; "
        f"{totals.path:.0f} m driven, {totals.contacts} contacts; digest {totals.digest[:16]}"
    )
    assert {failure.seed: failure.violations for failure in totals.failures} == {}
    assert totals.drove >= 0.9 * SEEDS
    assert totals.path >= 1.2 * SEEDS
    rare = {what: totals.counts[what] for what, least in PER_SEED.items() if totals.counts[what] < least * SEEDS}
    assert rare == {}
    never = [kind.name for kind in KINDS if totals.counts[f"fault: {kind.name}"] < 0.02 * SEEDS]
    assert never == []
