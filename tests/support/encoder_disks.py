"""Encoder disks as two sensors see them, and the changes that they give while they turn."""

import random
from collections.abc import Collection, Iterator
from itertools import pairwise
from math import exp

from giraff_core.encoder_disk import Edge, Pattern
from giraff_setup.encoder.transitions import Transition

PAIRS = 40
Change = tuple[float, tuple[bool, bool]]
"""Turns since the start, and the levels of A and B after it."""


def disk(
    phase: float = 90.0,
    a: float = 0.5,
    b: float = 0.5,
    no_a: Collection[int] = (),
    no_b: Collection[int] = (),
    pairs: int = PAIRS,
) -> Pattern:
    """Return a disk. `phase`: degrees by which B follows A; `a`, `b`: shares that are high; `no_a`: marks not there."""
    changes = list[tuple[float, int, bool]]()
    for channel, (duty, missing, late) in enumerate(((a, no_a, 0.0), (b, no_b, phase / 360.0))):
        for mark in set(range(pairs)) - set(missing):
            middle = mark + 0.4 + late
            for end, level in ((-duty / 2.0, True), (duty / 2.0, False)):
                changes.append(((middle + end) / pairs % 1.0, channel, level))
    levels = [False, False]
    edges = list[Edge]()
    for turn in range(2):  # the first one finds the levels at the turn's begin
        for at, channel, level in sorted(changes):
            levels[channel] = level
            if turn:
                edges.append(Edge(at, levels[0], levels[1]))
    return Pattern(4 * pairs, tuple(edges))


def turned(
    made: Pattern, turns: int = 6, *, backward: bool = False, noise_ms: float = 0.0, turn_ms: float = 200.0
) -> list[Transition]:
    """Return what a board tells of a disk that a motor turns from rest."""
    noise = random.Random(7)
    changes = [
        (_time(at, turn_ms) + noise.gauss(0.0, noise_ms), levels) for at, levels in _passed(made, turns, backward)
    ]
    told = [Transition(None, changes[0][1])]
    for (before, _), (after, levels) in pairwise(changes):
        told.append(Transition(max(0.0, after - before), levels))
    return told


def _passed(made: Pattern, turns: int, backward: bool) -> Iterator[Change]:
    for turn in range(turns):
        if not backward:
            yield from ((turn + edge.at, (edge.a, edge.b)) for edge in made.edges)
            continue
        for number in reversed(range(len(made.edges))):
            before = made.edges[number - 1]
            yield turn + 1.0 - made.edges[number].at, (before.a, before.b)


def _time(way: float, turn_ms: float, motor_ms: float = 150.0) -> float:
    """ms until a motor from rest has turned so far."""
    low, high = 0.0, way * turn_ms + 2.0 * motor_ms
    for _ in range(40):
        middle = (low + high) / 2.0
        if middle - motor_ms * (1.0 - exp(-middle / motor_ms)) < way * turn_ms:
            low = middle
        else:
            high = middle
    return high
