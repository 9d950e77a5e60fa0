"""Many seeds on all cores, and what they come to together."""

from __future__ import annotations

import gc
import hashlib
import multiprocessing
from collections import Counter
from collections.abc import Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from typing import Final

import msgspec

from giraff_sim.dst.scenarios import draw
from giraff_sim.dst.simulated_run import SECONDS, Outcome, known_settings, play

_CHUNK: Final = 4  # seeds handed to a process at a time


class Failure(msgspec.Struct, frozen=True, kw_only=True):
    """A seed that violated an invariant."""

    seed: int
    violations: tuple[str, ...]


class Totals(msgspec.Struct, kw_only=True):
    """What the seeds that were run have in common."""

    seeds: int = 0
    simulated: float = 0.0
    """s."""
    drove: int = 0
    """Seeds in which the robot drove."""
    path: float = 0.0
    """m."""
    near: float = 0.0
    """m of it with something less than half a metre from the body."""
    contacts: int = 0
    """Times the body came to touch something, whoever moved."""
    counts: Counter[str] = msgspec.field(default_factory=Counter)
    failures: list[Failure] = []
    motion_digest: str = ""
    """SHA-256 of the motion digests of all seeds, in order."""
    event_digest: str = ""

    def add(self, outcome: Outcome, seconds: float) -> None:
        """Count one more."""
        self.seeds += 1
        self.simulated += seconds
        self.drove += outcome.drove
        self.path += outcome.path
        self.near += outcome.near
        self.contacts += outcome.contacts
        self.counts.update(outcome.counts)
        if outcome.violations:
            told = tuple(f"({each.rule}) {each.what}" for each in outcome.violations)
            self.failures.append(Failure(seed=outcome.seed, violations=told))
        self.motion_digest = _chained(self.motion_digest, outcome.motion_digest)
        self.event_digest = _chained(self.event_digest, outcome.event_digest)


def _chained(before: str, digest: str) -> str:
    return hashlib.sha256((before + digest).encode()).hexdigest()


def run_many(seeds: Iterable[int], jobs: int) -> Iterator[Outcome]:
    """The outcome of each seed, in order, on `jobs` processes."""
    if jobs == 1:
        yield from map(run_one, seeds)
        return
    with ProcessPoolExecutor(jobs, multiprocessing.get_context("spawn")) as pool:
        yield from pool.map(run_one, seeds, chunksize=_CHUNK)


def run_one(seed: int) -> Outcome:
    """A seed with the robot file's robot."""
    # A run makes and drops hundreds of thousands of small objects, none of them in a cycle before its end.
    collects = gc.isenabled()
    gc.disable()
    try:
        return play(draw(seed, SECONDS), known_settings())
    finally:
        gc.collect()
        if collects:
            gc.enable()
