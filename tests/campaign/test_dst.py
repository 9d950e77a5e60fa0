"""Two thousand seeds of the deterministic simulation."""

from __future__ import annotations

import os
import time
from typing import Final

import msgspec

from giraff_sim.dst.drill import SECONDS
from giraff_sim.dst.many import Totals, run_many
from tests.support.report import report

SEEDS: Final = 2_000
"""From 0 on: those of tests/dst too, and then fresh ones."""
LEG: Final = 500
"""Seeds between two times that the figures so far are told."""


def test_two_thousand_seeds_violate_no_invariant() -> None:
    totals, began = Totals(), time.monotonic()
    for outcome in run_many(range(SEEDS), os.cpu_count() or 1):
        totals.take(outcome, SECONDS)
        if totals.seeds % LEG == 0:
            told = msgspec.to_builtins(totals)
            counts = dict(sorted(totals.counts.items()))
            report("campaign/dst", {"took_s": round(time.monotonic() - began), **told, "counts": counts})
    assert totals.failures == []
    assert totals.seeds == SEEDS
    assert totals.drove >= 0.9 * SEEDS
