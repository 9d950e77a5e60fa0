"""What is heard of a robot, made into what a person wants to know. No clock, no network: both come in."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final, Generic, TypeVar

from giraff_cli.telemetry.rate import RateEstimator, Totals
from giraff_schemas.localization import MapPose
from giraff_schemas.messages import (
    BaseState,
    Battery,
    EStop,
    GuardedCommand,
    GuardState,
    Lease,
    Odometry,
    Range,
    Sample,
    Tilt,
    Wheels,
)
from giraff_schemas.topics import (
    BASE,
    BATTERY,
    CMD_VEL,
    ESTOP,
    GUARD,
    LEASE,
    ODOM,
    POSE,
    RANGE,
    TILT,
    TOPICS,
    WHEELS,
    Topic,
)

SampleT = TypeVar("SampleT", bound=Sample)

FRESH: Final = 1.0  # s; twice the period of the slowest topic
_ORDER: Final = {topic.key: number for number, topic in enumerate(TOPICS)}


@dataclass(frozen=True)
class Latest(Generic[SampleT]):
    """The newest sample of a key."""

    sample: SampleT
    age: float
    """s since it was heard."""

    @property
    def fresh(self) -> bool:
        """Whether it speaks of now."""
        return self.age <= FRESH


@dataclass(frozen=True)
class KeyRate:
    """How a key flows now."""

    hz: float | None
    """None: it does not."""
    lost: int
    losing: bool
    """Any of the last moments was lost."""
    age: float
    """s since the newest sample was heard."""

    @property
    def fresh(self) -> bool:
        """Whether it speaks of now."""
        return self.age <= FRESH


@dataclass(frozen=True, kw_only=True)
class Snapshot:
    """A robot at one moment, as it is heard. None where nothing is known."""

    silence: float | None
    """s since anything was heard; None: nothing ever was."""
    odometry: Latest[Odometry] | None
    wheels: Latest[Wheels] | None
    tilt: Latest[Tilt] | None
    command: Latest[GuardedCommand] | None
    guard: Latest[GuardState] | None
    base: Latest[BaseState] | None
    battery: Latest[Battery] | None
    estop: Latest[EStop] | None
    lease: Latest[Lease] | None
    localization: Latest[MapPose] | None
    ranges: dict[str, Latest[Range] | None]
    """By sensor: first those that the guard knows of, in the order of the robot file."""
    rates: dict[str, KeyRate]
    """By key, in the order of the topics table."""
    services: dict[str, int]
    """By service, how many of it are on the network; 0: it was."""


class _Key:
    """A key: its newest sample, and a flow for each maker."""

    def __init__(self, topic: Topic[Any]) -> None:
        self.topic = topic
        self.flows: dict[str, RateEstimator] = {}
        self.sample: Any = None
        self.heard_ns = 0
        self._gone = Totals()

    def on_sample(self, sample: Sample, seconds: float, at_ns: int) -> None:
        flow = self.flows.get(sample.instance)
        if flow is None:
            self._retire(seconds)
            flow = self.flows[sample.instance] = RateEstimator(sample.seq, seconds)
        flow.on_sample(sample.seq, seconds)
        self.sample, self.heard_ns = sample, at_ns

    @property
    def lost(self) -> int:
        return self._totals.lost

    @property
    def rate(self) -> float | None:
        """Hz over the whole of it."""
        totals = self._totals
        return totals.made / totals.took if totals.took > 0.0 else None

    def rate_now(self, seconds: float) -> float | None:
        return self.flows[self.sample.instance].rate_now(seconds)

    def loses_now(self, seconds: float) -> bool:
        return any(flow.loses_now(seconds) for flow in self.flows.values())

    def begin(self) -> None:
        """Count from the newest sample on."""
        for flow in self.flows.values():
            flow.begin()
        self._gone = Totals(lost=self._gone.lost)

    @property
    def _totals(self) -> Totals:
        return sum((flow.totals for flow in self.flows.values()), self._gone)

    def _retire(self, seconds: float) -> None:
        """Keep only the totals of makers that have ended: a service that restarts for days must not fill the memory."""
        for maker in [maker for maker, flow in self.flows.items() if flow.has_ended(seconds)]:
            self._gone += self.flows.pop(maker).totals


class Telemetry:
    """Collects. Times are this host's boot clock in ns."""

    def __init__(self, sensors: tuple[str, ...] = ()) -> None:
        """`sensors`: names of the robot's ultrasonic sensors, as far as they are known before they are heard."""
        self._sensors = sensors
        self._keys: dict[str, _Key] = {}
        self._alive: dict[str, set[str]] = {}
        self._heard_ns: int | None = None

    def on_sample(self, topic: Topic[Any], key: str, sample: Sample, at_ns: int) -> None:
        """A sample of `key` (below the robot's name), which `topic` is or stands for, heard at `at_ns`."""
        if key not in self._keys:
            self._keys[key] = _Key(topic)
        self._keys[key].on_sample(sample, self._clock(topic, at_ns), at_ns)
        self._heard_ns = at_ns

    def forget(self, topic: Topic[Any]) -> None:
        """Of a topic without `*` nothing is heard any more because nobody listens."""
        self._keys.pop(topic.key, None)

    def begin(self) -> None:
        """Judge rates from now on: while processes start, nothing has its rate."""
        for key in self._keys.values():
            key.begin()

    def on_liveliness(self, service: str, instance: str, *, present: bool) -> None:
        """A service's token on the network has come or gone."""
        instances = self._alive.setdefault(service, set())
        if present:
            instances.add(instance)
        else:
            instances.discard(instance)

    @property
    def alive(self) -> frozenset[str]:
        """Services that are on the network."""
        return frozenset(service for service, instances in self._alive.items() if instances)

    @property
    def lost(self) -> dict[str, int]:
        """By key, samples that their makers numbered and nobody here heard; keys that lost none are left out."""
        return {name: lost for name in self._names() if (lost := self._keys[name].lost)}

    @property
    def rates_hz(self) -> dict[str, float]:
        """By key, over the whole time."""
        return {name: rate for name in self._names() if (rate := self._keys[name].rate) is not None}

    def newest(self, topic: Topic[SampleT], now_ns: int) -> Latest[SampleT] | None:
        """The newest sample of a topic without `*`."""
        return self._seen(topic.key, now_ns)

    def snapshot(self, now_ns: int) -> Snapshot:
        """Everything, as of now."""
        guard = self.newest(GUARD, now_ns)
        return Snapshot(
            silence=None if self._heard_ns is None else _since(self._heard_ns, now_ns),
            odometry=self.newest(ODOM, now_ns),
            wheels=self.newest(WHEELS, now_ns),
            tilt=self.newest(TILT, now_ns),
            command=self.newest(CMD_VEL, now_ns),
            guard=guard,
            base=self.newest(BASE, now_ns),
            battery=self.newest(BATTERY, now_ns),
            estop=self.newest(ESTOP, now_ns),
            lease=self.newest(LEASE, now_ns),
            localization=self.newest(POSE, now_ns),
            ranges={sensor: self._seen(range_key(sensor), now_ns) for sensor in self._all_sensors(guard)},
            rates={name: self._rate(self._keys[name], now_ns) for name in self._names()},
            services={service: len(instances) for service, instances in self._alive.items()},
        )

    def _seen(self, name: str, now_ns: int) -> Latest[Any] | None:
        key = self._keys.get(name)
        return None if key is None else Latest(key.sample, _since(key.heard_ns, now_ns))

    def _all_sensors(self, guard: Latest[GuardState] | None) -> dict[str, None]:
        """Names, each once."""
        guarded = () if guard is None else guard.sample.sensors
        heard = (name.partition("/")[2] for name in self._names() if self._keys[name].topic.key == RANGE.key)
        return dict.fromkeys((*self._sensors, *guarded, *heard))

    def _names(self) -> list[str]:
        """The keys heard so far, in the order of the topics table."""
        return sorted(self._keys, key=lambda name: (_ORDER[self._keys[name].topic.key], name))

    def _rate(self, key: _Key, now_ns: int) -> KeyRate:
        now = self._clock(key.topic, now_ns)
        return KeyRate(hz=key.rate_now(now), lost=key.lost, losing=key.loses_now(now), age=_since(key.heard_ns, now_ns))

    def _clock(self, topic: Topic[Any], at_ns: int) -> float:
        """s of the clock that paces a topic."""
        del topic
        return at_ns * 1e-9


def range_key(sensor: str) -> str:
    """Of the network's word for a sensor, which may be none that a key can have."""
    return RANGE.key.replace("*", sensor)


def _since(then_ns: int, now_ns: int) -> float:
    return (now_ns - then_ns) * 1e-9
