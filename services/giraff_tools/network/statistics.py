"""What the samples of one key tell of how they travel: counted by their makers' numbers. No clock, no network."""

from collections import Counter, deque
from dataclasses import dataclass
from typing import Final, NamedTuple

import msgspec

_RECALLED: Final = 10_000
"""Samples back that a late one is known to be late, and not lost or a double."""
_KEPT: Final = 10.0  # s of marks, by which the rate of now is told
_ENOUGH: Final = 0.25  # s that tell a rate
_LEAP: Final = 2.0
"""s by which stamps and arrivals differ where a clock leaps. Samples that come late differ by less."""
_AGE_STEP_MS: Final = 0.1


class Header(msgspec.Struct, frozen=True):
    """What every sample starts with; the rest of it is not looked at."""

    seq: int
    stamp_ns: int
    instance: str


@dataclass(frozen=True)
class Arrival:
    """One sample as it came."""

    key: str
    size: int
    """Bytes."""
    head: Header | None
    """None: it cannot be read."""
    at: float
    """Monotonic, s."""
    wall_ns: int
    """By this host's wall clock."""


class _Mark(NamedTuple):
    """A sample, and when it came."""

    head: Header
    at: float
    """Monotonic, s."""


class AgeHistogram:
    """A distribution of ages in ms, as steps of 0.1 ms: it does not grow with a long run."""

    def __init__(self) -> None:
        self._counts: Counter[int] = Counter()

    def add(self, milliseconds: float) -> None:
        self._counts[round(milliseconds / _AGE_STEP_MS)] += 1

    def quantile(self, share: float) -> float | None:
        """The age that `share` (0..1) of all do not exceed; None: there are none."""
        wanted, seen = share * self._counts.total(), 0
        for step, count in sorted(self._counts.items()):
            seen += count
            if seen >= wanted:
                return round(step * _AGE_STEP_MS, 1)
        return None


class PublisherStatistics:
    """The samples of one maker on one key, from the first that was heard."""

    def __init__(self, first: Arrival, head: Header) -> None:
        self.reordered = self.duplicated = 0
        self.ages = AgeHistogram()
        """By the two hosts' wall clocks, ms."""
        self.newest = first
        self._first = self._last = _Mark(head, first.at)
        self._heard = 0
        self._missing: set[int] = set()
        self._marks: deque[_Mark] = deque()

    def add(self, arrival: Arrival, head: Header) -> None:
        """Another sample, or the first."""
        self.ages.add((arrival.wall_ns - head.stamp_ns) * 1e-6)
        self.newest = arrival
        newest = self._last.head.seq
        if self._heard == 0 or head.seq > newest:
            self._heard += 1
            self._miss(newest + 1, head.seq)
            self._last = _Mark(head, arrival.at)
            self._mark()
        elif head.seq in self._missing:
            self._heard += 1
            self._missing.discard(head.seq)
            self.reordered += 1
        elif head.seq >= self._first.head.seq:
            self.duplicated += 1  # one from before the first was on its way before anybody listened

    @property
    def sent(self) -> int:
        """What the maker has numbered between the first and the newest that were heard, both counted."""
        return self._last.head.seq - self._first.head.seq + 1

    @property
    def heard(self) -> int:
        """Of these."""
        return self._heard

    @property
    def lost(self) -> int:
        """Of these, what has not come."""
        return self.sent - self._heard

    @property
    def rate(self) -> float | None:
        """Hz, by the maker's own numbers and stamps, whatever became of the samples; None: too few to tell.

        Where the maker's wall clock leapt, it is by when the samples came.
        """
        return _rate(self._first, self._last)

    @property
    def leap(self) -> float:
        """s. How far the maker's wall clock leapt between the first and the newest sample; 0: it did not."""
        return _leap(self._first, self._last)

    def rate_over(self, seconds: float) -> float | None:
        """The same of the last `seconds`."""
        since = next((mark for mark in self._marks if mark.at >= self._last.at - seconds), None)
        return None if since is None else _rate(since, self._last)

    def _miss(self, begin: int, end: int) -> None:
        forget = end - _RECALLED
        if end > begin:
            self._missing.update(range(max(begin, forget), end))
        if len(self._missing) > _RECALLED:
            self._missing = {seq for seq in self._missing if seq >= forget}

    def _mark(self) -> None:
        if not self._marks or self._last.at - self._marks[-1].at >= _ENOUGH:
            self._marks.append(self._last)
            while self._marks[0].at < self._last.at - _KEPT:
                self._marks.popleft()


class TopicStatistics:
    """All that comes on one key."""

    def __init__(self, key: str) -> None:
        self.key = key
        self.counts: dict[str, PublisherStatistics] = {}
        """By maker's instance."""
        self.unreadable = 0
        self.samples = 0
        self.bytes = 0
        self.smallest = self.largest = 0
        self._first_at = self._last_at = 0.0
        self._first_size = 0

    def on_sample(self, arrival: Arrival) -> None:
        """A sample."""
        if self.samples == 0:
            self._first_at, self._first_size = arrival.at, arrival.size
            self.smallest = arrival.size
        self.samples += 1
        self.bytes += arrival.size
        self.smallest, self.largest = min(self.smallest, arrival.size), max(self.largest, arrival.size)
        self._last_at = arrival.at
        head = arrival.head
        if head is None:
            self.unreadable += 1
            return
        if head.instance not in self.counts:
            self.counts[head.instance] = PublisherStatistics(arrival, head)
        self.counts[head.instance].add(arrival, head)

    @property
    def arrival_rate(self) -> float | None:
        """Hz, by when they come: for samples that no maker has numbered. None: too few to tell."""
        took = self._last_at - self._first_at
        return (self.samples - 1) / took if took >= _ENOUGH else None

    @property
    def bytes_per_second(self) -> float | None:
        """Of the payloads, as they come; None: too few to tell."""
        took = self._last_at - self._first_at
        return (self.bytes - self._first_size) / took if took > 0.0 else None


def _rate(first: _Mark, last: _Mark) -> float | None:
    took = last.at - first.at if _leap(first, last) else (last.head.stamp_ns - first.head.stamp_ns) * 1e-9
    return (last.head.seq - first.head.seq) / took if took >= _ENOUGH else None


def _leap(first: _Mark, last: _Mark) -> float:
    leap = (last.head.stamp_ns - first.head.stamp_ns) * 1e-9 - (last.at - first.at)
    return leap if abs(leap) > _LEAP else 0.0
