"""Measure phase, duty and missing marks of an encoder while its wheel turns one way at an even speed. Pure.

A pair is one black and one white mark of the disk, and so one period of each channel.
"""

import cmath
import math
from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise
from statistics import fmean, median, pstdev
from typing import Final, NamedTuple

from giraff_setup.encoder.transitions import CHANNELS, A, B, Edge, Run, Transition, runs_of

FEWEST: Final = 40
"""Edges, of ten pairs: fewer are not judged."""
_STRETCH: Final = 16  # edges at least of a stretch of even speed: a wheel that trembles gives fewer in a row
_EVEN: Final = (0.6, 1.6)  # of the usual period: the wheel speeds up, or a mark is missing, outside of it
_SILENT: Final = 0.05  # of the other channel's edges, at most
_UNEVEN: Final = 0.03  # of a period, ten degrees: the deviation of a phase that is not the same everywhere
_MOST_PER_TURN: Final = 4  # places of one ring with missing marks that are still told from dirt
_SAME_PLACE: Final = 2  # states


class Turn(NamedTuple):
    """Marks that are missing at the same places of each turn."""

    states: int
    """States of a turn: four a pair."""
    marks: int
    """Marks that are missing in each."""


class Channel(NamedTuple):
    """The figures of one channel."""

    edges: int
    duty: float | None
    """Share of a period in which it is high. None: unknown."""
    duty_spread: float
    """Standard deviation of `duty` over the periods."""
    missing: int
    """Marks that it passed over while the other channel went on."""
    turn: Turn | None
    """The turn after which they come again. None: at changing places, or too few were seen."""
    apart: int | None
    """States between two missing marks, where no more than two were seen. None: it is not known."""
    flickers: int
    """Pairs of edges where no mark begins or ends."""


class Figures(NamedTuple):
    """The figures of one encoder."""

    transitions: int
    losses: int
    """Places where transitions before were lost, or were too short for the board."""
    edges: int
    """Edges at an even speed, which the other figures are made of."""
    period_ms: float
    """ms. Usual time of a pair."""
    b_after_a: float | None
    """Share of a period by which B follows A: 0.25 or 0.75 is ideal. None: unknown."""
    spread: float
    """Standard deviation of `b_after_a` over the periods."""
    a: Channel
    b: Channel
    worst: tuple[Run, float] | None
    """The run and the ms in it where most is wrong. None: there is nothing to see."""

    @property
    def is_enough(self) -> bool:
        """Tells that there is enough to judge."""
        return self.edges >= FEWEST

    @property
    def channels(self) -> Iterator[tuple[str, Channel]]:
        """Each channel after its name."""
        return zip(CHANNELS, (self.a, self.b), strict=True)

    @property
    def leads(self) -> str:
        """Name of the channel that is ahead of the other one."""
        return CHANNELS[A if self.b_after_a is None or self.b_after_a < 0.5 else B]

    @property
    def phase(self) -> float | None:
        """Return by how many degrees of a period the channel that leads is ahead; 90 is ideal."""
        return None if self.b_after_a is None else 360.0 * min(self.b_after_a, 1.0 - self.b_after_a)

    @property
    def late(self) -> float:
        """Degrees of a period by which B must follow A later than it does; negative: earlier."""
        if self.b_after_a is None:
            return 0.0
        return 360.0 * ((0.25 if self.b_after_a < 0.5 else 0.75) - self.b_after_a)

    @property
    def silent(self) -> str | None:
        """Name of the one channel that does not change while the other one does."""
        counts = self.a.edges, self.b.edges
        return CHANNELS[counts.index(min(counts))] if min(counts) <= _SILENT * max(counts) else None


_Stretch = tuple[Run, Sequence[Edge]]
"""Edges at an even speed, with their run."""
_Phase = tuple[Run, float, float]
"""A change of B: its run, its ms, and by which share of a period it follows A's."""
_At = tuple[Run, float]
"""A run, and a ms in it."""


class _Gap(NamedTuple):
    """Edges of one channel in a row, in which the other one should have changed."""

    at: float
    place: int
    """States from the stretch's begin."""
    marks: int
    """Marks that the other channel passed over."""
    flickers: int


def analyse(transitions: Sequence[Transition]) -> Figures:
    """Return what these say of their encoder, whatever they are."""
    runs = list(runs_of(transitions))
    period = _period(runs)
    stretches = [(run, stretch) for run in runs for stretch in _even(run.edges, period)]
    edges = [stretch for _, stretch in stretches]
    by_level = [
        [(run, at, share) for run, stretch in stretches for at, share in _phases(stretch, level, period)]
        for level in (False, True)
    ]
    b_after_a, spread = _phase([[share for _, _, share in phases] for phases in by_level])
    gaps = [[list(_gaps(stretch, channel, period)) for stretch in edges] for channel in (A, B)]
    return Figures(
        transitions=len(transitions),
        losses=sum(each.after_ms is None for each in transitions[1:]),
        edges=sum(map(len, edges)),
        period_ms=period,
        b_after_a=b_after_a,
        spread=spread,
        a=_channel(edges, A, period, gaps),
        b=_channel(edges, B, period, gaps),
        worst=_worst(stretches, gaps, [*by_level[0], *by_level[1]], spread),
    )


def _worst(
    stretches: Sequence[_Stretch], gaps: Sequence[Sequence[Sequence[_Gap]]], phases: Sequence[_Phase], spread: float
) -> _At | None:
    """Find a mark that is missing, else a flicker, else the worst of uneven phases, else the middle."""
    odd = [(gap, run) for channel in gaps for (run, _), found in zip(stretches, channel, strict=True) for gap in found]
    if odd:
        most = max(gap.marks for gap, _ in odd)
        worst = [(run, gap.at) for gap, run in odd if gap.marks == most]
        return worst[len(worst) // 2]
    if spread > _UNEVEN:
        run, at, _ = max(phases, key=lambda each: abs(each[2] % 0.5 - 0.25))
        return run, at
    if stretches:
        run, edges = max(stretches, key=lambda each: len(each[1]))
        return run, edges[len(edges) // 2].at
    return None


def _period(runs: Iterable[Run]) -> float:
    """Return the usual time from one edge to the next of its kind, of the channel that has more; 0: unknown."""
    lengths = dict[int, list[float]]()
    for channel in (A, B):
        times = (_times(run.edges, channel, level) for run in runs for level in (False, True))
        lengths[channel] = [later - sooner for each in times for sooner, later in pairwise(each)]
    most = max(lengths.values(), key=len)
    return median(most) if most else 0.0


def _times(edges: Iterable[Edge], channel: int, level: bool) -> list[float]:
    return [edge.at for edge in edges if edge.channel == channel and edge.level == level]


def _even(edges: Sequence[Edge], period: float) -> Iterator[Sequence[Edge]]:
    """Split where no edge comes for longer than a period: the wheel stands there, or is not yet at its speed."""
    begin = 0
    for end in range(1, len(edges) + 1):
        if end == len(edges) or edges[end].at - edges[end - 1].at > period:
            if end - begin >= _STRETCH:
                yield edges[begin:end]
            begin = end


def _periods(edges: Sequence[Edge], channel: int, level: bool, period: float) -> Iterator[tuple[float, float]]:
    """Begin and length of each period of a usual length."""
    for sooner, later in pairwise(_times(edges, channel, level)):
        if _EVEN[0] * period <= later - sooner <= _EVEN[1] * period:
            yield sooner, later - sooner


def _phases(edges: Sequence[Edge], level: bool, period: float) -> Iterator[tuple[float, float]]:
    """Each time at which B takes a level as A did before, and by which share of A's period later."""
    times = iter(_times(edges, B, level))
    at = next(times, math.inf)
    for begin, length in _periods(edges, A, level, period):
        while at < begin:
            at = next(times, math.inf)
        if at < begin + length:
            yield at, (at - begin) / length


def _duties(edges: Sequence[Edge], channel: int, period: float) -> Iterator[float]:
    """Each share of a period in which a channel is high."""
    falls = iter(_times(edges, channel, level=False))
    fall = next(falls, math.inf)
    for begin, length in _periods(edges, channel, level=True, period=period):
        while fall <= begin:
            fall = next(falls, math.inf)
        if fall < begin + length:
            yield (fall - begin) / length


def _phase(by_level: Sequence[Sequence[float]]) -> tuple[float | None, float]:
    """Return the mean of both kinds of edges, which does not depend on the duties, and the larger deviation."""
    found = [_on_circle(shares) for shares in by_level]
    means = [mean for mean, _ in found if mean is not None]
    return _on_circle(means)[0] if len(means) == len(found) else None, max(spread for _, spread in found)


def _on_circle(shares: Sequence[float]) -> tuple[float | None, float]:
    """Return mean and deviation of shares of a period, of which 1 is 0 again. None: they are at random."""
    mean = sum(cmath.exp(2j * math.pi * share) for share in shares)
    if abs(mean) <= 0.1 * len(shares):
        return None, 0.0
    middle = cmath.phase(mean) / (2.0 * math.pi) % 1.0
    # Within half a period of the first middle the plain mean counts each alike.
    around = [(share - middle + 0.5) % 1.0 - 0.5 for share in shares]
    return (middle + fmean(around)) % 1.0, pstdev(around)


def _gaps(edges: Sequence[Edge], channel: int, period: float) -> Iterator[_Gap]:
    """Find where a channel changes several times in a row.

    A reversal, and two channels that change nearly at once, give two in a row. A mark that is missing on the other
    ring gives three: from the first to the last is a period. Less is a flicker.
    """
    place, begin = 0, 0
    for end in range(1, len(edges) + 1):
        if end < len(edges) and edges[end].channel == edges[begin].channel:
            continue
        span = edges[end - 1].at - edges[begin].at
        pairs = (end - begin - 1) // 2
        marks = min(pairs, round(span / period)) if period else 0
        if pairs and edges[begin].channel == channel:
            yield _Gap((edges[begin].at + edges[end - 1].at) / 2.0, place, marks, pairs - marks)
        place += 1 + 4 * marks
        begin = end


def _channel(
    stretches: Sequence[Sequence[Edge]], channel: int, period: float, gaps: Sequence[Sequence[Sequence[_Gap]]]
) -> Channel:
    """`gaps`: those of each channel, by their stretches. In those of the other one, this one should have changed."""
    duties = [share for stretch in stretches for share in _duties(stretch, channel, period)]
    passed = [[gap for gap in found if gap.marks] for found in gaps[1 - channel]]
    places = [[gap.place for gap in found] for found in passed]
    pairs = [later - sooner for found in places for sooner, later in pairwise(found)]
    return Channel(
        sum(edge.channel == channel for stretch in stretches for edge in stretch),
        fmean(duties) if duties else None,
        pstdev(duties) if duties else 0.0,
        sum(gap.marks for found in passed for gap in found),
        _turn(passed),
        pairs[0] if len(pairs) == 1 else None,
        sum(gap.flickers for found in gaps[channel] for gap in found),
    )


def _turn(gaps: Sequence[Sequence[_Gap]]) -> Turn | None:
    """Return the turn after which all places come again; None: they do not, or too few are known."""
    for places in range(1, _MOST_PER_TURN + 1):
        turns = [
            later.place - sooner.place for found in gaps for sooner, later in zip(found, found[places:], strict=False)
        ]
        if len(turns) > places and max(turns) - min(turns) <= _SAME_PLACE:
            marks = places * fmean(gap.marks for found in gaps for gap in found)
            return Turn(round(median(turns)), round(marks))
    return None
