"""One sample as it came over the network, and how many of a key have come."""

from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, NamedTuple

import msgspec

from giraff_schemas.topics import Topic, topic_of


class RawSample(NamedTuple):
    """A sample with what it takes to say it again."""

    at_ns: int
    """time.monotonic_ns when it came."""
    key: str
    payload: bytes
    encoding: str


@lru_cache(maxsize=1000)
def row_of(key: str) -> Topic[Any] | None:
    """Return the row of the topics table that a whole key is of. None: the table has none."""
    return topic_of(key.split("/", 2)[-1])


class Start(NamedTuple):
    """What every sample of Giraff starts with."""

    seq: int
    stamp_ns: int
    instance: str


def start_of(content: Any) -> Start | None:
    """Of a decoded payload; None: it is none of Giraff's."""
    if not isinstance(content, dict):
        return None
    seq, stamp_ns, instance = content.get("seq"), content.get("stamp_ns"), content.get("instance")
    if not (isinstance(seq, int) and isinstance(stamp_ns, int) and isinstance(instance, str)):
        return None
    return Start(seq, stamp_ns, instance) if seq >= 0 and 0 <= stamp_ns < 1 << 63 else None


@dataclass
class _Flow:
    """Samples of one maker on one key."""

    first: int
    last: int
    count: int = 0


@dataclass
class LossCounter:
    """Counts the samples of one key, and by their numbers those that are missing.

    `giraff_tools.network.statistics` tells the late ones from the doubles, too, and rates and ages; it takes several
    times as long for a sample, which a recorder that must cost little does not have, and wants them as they come: a
    file need not.
    """

    count: int = 0
    _flows: dict[str, _Flow] = field(default_factory=dict)

    def add(self, start: Start | None) -> None:
        self.count += 1
        if start is not None:
            seq = start.seq
            flow = self._flows.get(start.instance)
            if flow is None:
                flow = self._flows[start.instance] = _Flow(seq, seq)
            flow.count += 1
            if seq > flow.last:
                flow.last = seq
            elif seq < flow.first:
                flow.first = seq

    @property
    def lost(self) -> int:
        """Numbers that never came between the first and the last of each maker."""
        return sum(max(0, flow.last - flow.first + 1 - flow.count) for flow in self._flows.values())


class Count(msgspec.Struct, frozen=True):
    """Of one key in a recording."""

    samples: int
    lost: int
