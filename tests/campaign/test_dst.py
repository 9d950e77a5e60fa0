"""Twenty thousand seeds of the deterministic simulation.

They take hours, so what the seeds so far have come to is kept: a run that was interrupted goes on where it stopped,
unless what they run has changed since.
"""

from __future__ import annotations

import os
import time

import msgspec
import pytest

from giraff_node.state import write_file_durably
from giraff_sim.board import ROOT
from giraff_sim.dst.drill import SECONDS
from giraff_sim.dst.many import Totals, run_many
from tests.campaign.records import source_hash, sources_of, write_record

MODULE = "giraff_sim.dst.many"
FIRST = 1000  # beyond the fixed seeds of tests/dst
SEEDS = 20_000
LEG = 500  # seeds between two times the totals are kept
KEPT = ROOT / "build" / "campaign" / "dst.json"


class Progress(msgspec.Struct, kw_only=True, forbid_unknown_fields=True):
    """The seeds so far."""

    source_sha256: str
    totals: Totals
    took: float = 0.0
    """s."""

    def keep(self) -> None:
        KEPT.parent.mkdir(parents=True, exist_ok=True)
        write_file_durably(KEPT, msgspec.json.encode(self))


def so_far() -> Progress:
    """Where an interrupted run of the same sources stopped, or the beginning."""
    sources = source_hash(sources_of(MODULE))
    if KEPT.exists():
        kept = msgspec.json.decode(KEPT.read_bytes(), type=Progress, dec_hook=lambda kind, told: kind(told))
        if kept.source_sha256 == sources:
            return kept
    return Progress(source_sha256=sources, totals=Totals())


@pytest.mark.timeout(0)
def test_twenty_thousand_seeds_violate_no_invariant() -> None:
    progress = so_far()
    totals = progress.totals
    while totals.seeds < SEEDS:
        began = time.monotonic()
        first = FIRST + totals.seeds
        for outcome in run_many(range(first, first + LEG), os.cpu_count() or 1):
            totals.take(outcome, SECONDS)
        progress.took += time.monotonic() - began
        progress.keep()
    path = write_record(
        "dst",
        {
            "first_seed": FIRST,
            "seeds": totals.seeds,
            "simulated_s": totals.simulated,
            "took_s": round(progress.took, 1),
            "drove_share": totals.drove / totals.seeds,
            "path_m": round(totals.path, 1),
            "contacts": totals.contacts,
            "counts": dict(sorted(totals.counts.items())),
            "failures": {str(failure.seed): failure.violations for failure in totals.failures},
            "digest": totals.digest,
        },
        sources_of(MODULE),
    )
    print(path.read_text())
    assert totals.failures == []
    assert totals.drove >= 0.9 * SEEDS
