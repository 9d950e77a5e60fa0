"""Twenty thousand seeds of the deterministic simulation."""

from __future__ import annotations

import os
import time

import pytest

from giraff_sim.dst.drill import SECONDS
from giraff_sim.dst.many import Totals, run_many
from tests.campaign.records import write_record

FIRST = 1000  # beyond the fixed seeds of tests/dst
SEEDS = 20_000


@pytest.mark.timeout(0)
def test_twenty_thousand_seeds_violate_no_invariant() -> None:
    totals = Totals()
    began = time.monotonic()
    for outcome in run_many(range(FIRST, FIRST + SEEDS), os.cpu_count() or 1):
        totals.take(outcome, SECONDS)
    path = write_record(
        "dst",
        {
            "first_seed": FIRST,
            "seeds": totals.seeds,
            "simulated_s": totals.simulated,
            "took_s": round(time.monotonic() - began, 1),
            "drove_share": totals.drove / totals.seeds,
            "path_m": round(totals.path, 1),
            "contacts": totals.contacts,
            "counts": dict(sorted(totals.counts.items())),
            "failures": {str(failure.seed): failure.violations for failure in totals.failures},
            "digest": totals.digest,
        },
    )
    print(path.read_text())
    assert totals.failures == []
    assert totals.drove >= 0.9 * SEEDS
