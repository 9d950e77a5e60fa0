"""Two thousand seeds of the deterministic simulation.

They take long, so the record is written as they go: a run that was interrupted goes on where the newest one stopped,
on any machine, unless what the seeds run has changed since.
"""

from __future__ import annotations

import os
import time

import msgspec
import pytest

from giraff_sim.dst.drill import SECONDS
from giraff_sim.dst.many import Totals, run_many
from tests.campaign.records import FIRMWARE, RECORDS, judged, write_record

NAME = "dst"
MODULE = "giraff_sim.dst.many"
FIRST = 0  # those of tests/dst too, and then fresh ones
SEEDS = 2_000
LEG = 500  # seeds between two times the record is written


class Record(msgspec.Struct, kw_only=True):
    """What is read of a record."""

    files: dict[str, str]
    first_seed: int
    took_s: float
    totals: Totals


class Judged(msgspec.Struct):
    """What is read of a record of which nothing more may be known."""

    files: dict[str, str] = {}


def so_far(files: dict[str, str]) -> Record:
    """Where an interrupted run of the same files stopped, or the beginning."""
    for path in sorted(RECORDS.glob(f"*-{NAME}.json"), reverse=True):
        if msgspec.json.decode(path.read_bytes(), type=Judged).files != files:
            continue
        kept = msgspec.json.decode(path.read_bytes(), type=Record, dec_hook=lambda kind, told: kind(told))
        if kept.first_seed == FIRST:
            return kept
    return Record(files=files, first_seed=FIRST, took_s=0.0, totals=Totals())


@pytest.mark.timeout(0)
def test_two_thousand_seeds_violate_no_invariant() -> None:
    files = judged(MODULE, also=FIRMWARE)
    record = so_far(files)
    totals = record.totals
    while totals.seeds < SEEDS:
        began = time.monotonic()
        first = FIRST + totals.seeds
        for outcome in run_many(range(first, first + LEG), os.cpu_count() or 1):
            totals.take(outcome, SECONDS)
        record.took_s = round(record.took_s + time.monotonic() - began, 1)
        assert judged(MODULE, also=FIRMWARE) == files, "the sources have changed meanwhile"
        path = write_record(
            NAME,
            {
                "first_seed": FIRST,
                "took_s": record.took_s,
                "totals": {**msgspec.to_builtins(totals), "counts": dict(sorted(totals.counts.items()))},
            },
            files,
        )
        print(f"{path.name}: {totals.seeds} seeds, {len(totals.failures)} failures")
    assert totals.failures == []
    assert totals.drove >= 0.9 * SEEDS
