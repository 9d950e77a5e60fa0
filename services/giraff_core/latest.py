"""The newest of all that is heard of a robot, and which of its services are there. No clock, no network."""

from dataclasses import dataclass
from typing import Any, Final, Generic

from giraff_schemas.messages import Sample
from giraff_schemas.topics import TOPICS, SampleT, Topic, covers

FRESH: Final = 1.0
"""s after which a sample says nothing of now."""
_PERIODS: Final = 3
"""Periods of a slow topic: one sample that is lost makes nobody silent."""
_MOST: Final = 20
"""Publishers that are remembered of one key: a service that restarts for days must not fill the memory."""
_TOPICS: Final = {topic.schema: topic for topic in TOPICS}


def is_fresh(topic: Topic[Any], age: float) -> bool:
    """Return whether a sample of this topic that was heard `age` s ago still says something of now."""
    return age <= max(FRESH, _PERIODS / topic.rate_hz)


@dataclass(frozen=True)
class Latest(Generic[SampleT]):
    """The newest sample of one publisher on one key."""

    sample: SampleT
    age: float
    """s since it was heard."""

    @property
    def fresh(self) -> bool:
        """Return whether it still says something of now."""
        return is_fresh(_TOPICS[type(self.sample)], self.age)


class LatestSamples:
    """Hears a robot. Times are any one clock's ns."""

    def __init__(self) -> None:
        self.instances: dict[str, set[str]] = {}
        """By service, the processes of it that are on the network; none: it was there."""
        self._heard: dict[str, dict[str, tuple[Sample, int]]] = {}  # by key and publisher, the newest last

    def on_sample(self, topic: Topic[Any], key: str, sample: Sample, at_ns: int) -> None:
        """Remember a sample of `key` (below the robot's name), which `topic` is or stands for, heard at `at_ns`."""
        del topic
        by_publisher = self._heard.setdefault(key, {})
        by_publisher.pop(sample.instance, None)
        by_publisher[sample.instance] = sample, at_ns
        if len(by_publisher) > _MOST:
            del by_publisher[next(iter(by_publisher))]

    def add(self, sample: Sample, now: float) -> None:
        """Remember a sample that was heard just now; `now`: s of that clock."""
        topic = _TOPICS[type(sample)]
        key = topic.key.replace("*", getattr(sample, topic.names)) if topic.names else topic.key
        self.on_sample(topic, key, sample, round(now * 1e9))

    def on_liveliness(self, service: str, instance: str, *, present: bool) -> None:
        """A service's token on the network has come or gone."""
        instances = self.instances.setdefault(service, set())
        (instances.add if present else instances.discard)(instance)

    @property
    def alive(self) -> frozenset[str]:
        """Services that are on the network."""
        return frozenset(service for service, instances in self.instances.items() if instances)

    def latest(self, topic: Topic[SampleT], now_ns: int) -> Latest[SampleT] | None:
        """Return the newest sample of a topic."""
        return next(iter(self.all(topic, now_ns)), None)

    def all(self, topic: Topic[SampleT], now_ns: int) -> list[Latest[SampleT]]:
        """Return the newest sample of each key and publisher of a topic, the newest first."""
        found = (heard for key in self._heard if covers(topic, key) for heard in reversed(self._heard[key].values()))
        latest: list[Latest[SampleT]] = [Latest(sample, (now_ns - at_ns) * 1e-9) for sample, at_ns in found]  # type: ignore[arg-type]  # the key tells the type
        return sorted(latest, key=lambda each: each.age)
