"""What a reader of a recording could not read: damaged parts of the file, and messages that are none."""

from collections.abc import Sequence
from typing import Final

import msgspec

from giraff_mcap.layout import Layout, Part
from giraff_schemas.text import printable

_MOST_NAMED: Final = 10


class Gap(msgspec.Struct, frozen=True):
    """A damaged place in a file. Times are in s since the first sample that can be read."""

    since: float | None
    """s. Time of the last sample before it. None: there is none."""
    until: float | None
    """s. Time of the first sample after it. None: there is none."""
    samples: int | None
    """Number of samples that are missing. None: not known."""

    @property
    def text(self) -> str:
        """What is missing, for people."""
        what = "an unknown number of samples" if self.samples is None else _samples(self.samples)
        if self.since is None:
            where = "at the beginning"
        else:
            where = f"after {self.since:.1f} s" + ("" if self.until is None else f" and before {self.until:.1f} s")
        return f"damaged: {what} {where} cannot be read"


class LeftOut(msgspec.Struct):
    """Messages of one topic that are no samples."""

    samples: int
    why: str
    """Reason of the first one."""


class Unread(msgspec.Struct):
    """All that is missing in what was read. It is false when everything was read."""

    gaps: list[Gap] = []
    left_out: dict[str, LeftOut] = {}
    """By topic. "?": nothing names it."""

    def __bool__(self) -> bool:
        return bool(self.gaps or self.left_out)

    @property
    def samples(self) -> int:
        """Number of samples that are known to be missing."""
        return sum(gap.samples or 0 for gap in self.gaps) + sum(left.samples for left in self.left_out.values())

    def leave_out(self, topic: str, why: str, samples: int = 1) -> None:
        """Count messages that are left out."""
        self.left_out.setdefault(topic, LeftOut(0, why)).samples += samples

    def texts(self) -> list[str]:
        """Return a line for each, at most 22."""
        lines = [gap.text for gap in self.gaps[:_MOST_NAMED]]
        if (more := len(self.gaps) - _MOST_NAMED) > 0:
            lines.append(f"damaged at {more} more places")
        for topic, left in list(self.left_out.items())[:_MOST_NAMED]:
            lines.append(f"{_samples(left.samples)} of {printable(topic) or 'an empty topic'} left out: {left.why}")
        if (more := len(self.left_out) - _MOST_NAMED) > 0:
            lines.append(f"samples of {more} more topics left out")
        return lines


class UnreadParts:
    """Follows which parts of a file are read, and what is missing between them."""

    def __init__(self, layout: Layout) -> None:
        self._layout = layout
        self._missing: dict[int, int | None] = dict.fromkeys(layout.holes)
        self._times: dict[int, tuple[int, int]] = {}
        """ns since 1970. By offset: of the first and the last message."""
        self._read = 0

    def read(self, part: Part, times: Sequence[int]) -> None:
        """A part was read; `times` of its messages, ns since 1970."""
        self._read += len(times)
        if times:
            self._times[part.offset] = min(times), max(times)

    def damaged(self, part: Part) -> None:
        """A part cannot be read."""
        self._missing[part.offset] = part.messages

    def gaps(self) -> list[Gap]:
        """Return what is missing, once all parts were looked at."""
        places: dict[tuple[float | None, float | None], list[int | None]] = {}
        for offset, number in sorted(self._missing.items()):
            places.setdefault(self._between(offset), []).append(number)
        if self._layout.messages is not None:
            rest = self._layout.messages - self._read
            known = sum(sum(filter(None, numbers)) for numbers in places.values() if None not in numbers)
            unknown = [place for place, numbers in places.items() if None in numbers]
            if len(unknown) == 1 or rest <= known:  # a hole between two chunks need not hold any
                places |= {place: [max(0, rest - known)] for place in unknown}
            elif not places and rest > 0:
                places[self._between(0)] = [rest]
        counts = {place: None if None in numbers else sum(filter(None, numbers)) for place, numbers in places.items()}
        return [Gap(*place, number) for place, number in counts.items() if number != 0]

    def _between(self, offset: int) -> tuple[float | None, float | None]:
        """Return the times of the samples before and after a place in the file."""
        began = min((first for first, _ in self._times.values()), default=0)
        before = [last for at, (_, last) in self._times.items() if at < offset]
        after = [first for at, (first, _) in self._times.items() if at > offset]
        since, until = max(before, default=None), min(after, default=None)
        return None if since is None else (since - began) * 1e-9, None if until is None else (until - began) * 1e-9


def _samples(number: int) -> str:
    return f"{number} sample{'' if number == 1 else 's'}"
