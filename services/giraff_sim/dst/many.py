"""Many seeds on all cores, what they come to together, and the rare paths that they ought to reach."""

import gc
import hashlib
import multiprocessing
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from typing import Final

import msgspec

from giraff_sim.dst.scenarios import draw
from giraff_sim.dst.simulated_run import SECONDS, Kind, Outcome, known_settings, play

MARKS: Final = (
    "stop: forward blocked",
    "stop: backward blocked",
    "stop: forward slowed",
    "stop: slowed",
    "stop: no fresh command",
    "stop: the guard is not heard",
    "stop: the guard's command is too old",
    "stop: a range that this motion relies on is too old",
    "stop: a second guard",
    "stop: a second base",
    "stop: a second ranger",
    "stop: another ranger",
    "stop: the base board is in state command_timeout",
    "stop: emergency stop by the base board",
    "stop: emergency stop by keyboard",
    "stop: not armed since the left wheel was held",
    "stop: emergency stop by battery",
    "answer: stopped",
    "answer: released",
    "answer: the emergency stop was engaged anew meanwhile",
    "answer: the disk hangs",
    "answer: the robot is stopped, and a restart may not know",
    "answer: latch N is not the one engaged",
    "answer: the reset is not from within the last",
    "an emergency stop was lost with its base",
    "the same engages the emergency stop anew",
    "the joystick's button is pressed while the robot drives",
    "parameter: set",
    "parameter: refused",
    "parameter: saved",
    "parameter: not saved",
)
"""Beginnings of what a run counts on rare paths, beside a fault of each kind.

A suite that never got there has shown nothing about them."""

_CHUNK: Final = 4  # seeds handed to a process at a time


def unreached(counts: Mapping[str, int], kinds: tuple[Kind, ...]) -> list[str]:
    """Of these marks and kinds of fault, those that nothing counted begins with."""
    wanted = (*(f"fault: {kind.name}" for kind in kinds), *MARKS)
    return [mark for mark in wanted if not any(what.startswith(mark) for what in counts)]


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
