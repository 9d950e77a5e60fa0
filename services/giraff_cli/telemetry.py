"""What is heard and seen of a run, made into what a person wants to know. No clock, no network: both come in."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final, Generic, TypeVar

from giraff_cli.flow import Ages, Flow
from giraff_cli.motion import Apart, Comparison, Pose, Truth
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
)
from giraff_schemas.topics import (
    BASE,
    BATTERY,
    CMD_VEL,
    ESTOP,
    GUARD,
    LEASE,
    ODOM,
    RANGE,
    TICK,
    TILT,
    TOPICS,
    WHEELS,
    Topic,
)

SampleT = TypeVar("SampleT", bound=Sample)

_BY_BOARD: Final = {topic.key for topic in (TILT, RANGE, WHEELS, ODOM)}
"""What the boards' clocks pace: judged in simulated time, in which all three agree. The rest goes by the wall's."""

_FRESH: Final = 1.0  # s; twice the period of the slowest topic
_ORDER: Final = {topic.key: number for number, topic in enumerate(TOPICS)}


@dataclass(frozen=True)
class Seen(Generic[SampleT]):
    """The newest sample of a key."""

    sample: SampleT
    age: float
    """s since it was heard."""

    @property
    def fresh(self) -> bool:
        """Whether it speaks of now."""
        return self.age <= _FRESH


@dataclass(frozen=True)
class KeyRate:
    """How a key flows now."""

    hz: float | None
    """None: it does not."""
    nominal_hz: float
    lost: int


@dataclass(frozen=True)
class AgeSummary:
    """Of commands when they reached base's host, ms."""

    p50: float
    p99: float
    max: float


@dataclass(frozen=True, kw_only=True)
class Snapshot:
    """A run at one moment. None where nothing is known."""

    truth: Truth
    true_pose: Pose | None
    """The truth in the frame of odometry."""
    apart: Apart | None
    odometry: Seen[Odometry] | None
    tilt: Seen[Tilt] | None
    command: Seen[GuardedCommand] | None
    guard: Seen[GuardState] | None
    base: Seen[BaseState] | None
    battery: Seen[Battery] | None
    estop: Seen[EStop] | None
    lease: Seen[Lease] | None
    ranges: dict[str, Seen[Range] | None]
    """By sensor, in the order of the robot file."""
    rates: dict[str, KeyRate]
    """By key, in the order of the topics table."""
    age_ms: AgeSummary | None
    alive: frozenset[str]
    """Services that are on the network."""


class _Key:
    """A key: its newest sample, and a flow for each maker."""

    def __init__(self, topic: Topic[Any]) -> None:
        self.topic = topic
        self.flows: dict[str, Flow] = {}
        self.sample: Any = None
        self.heard_ns = 0

    def hear(self, sample: Sample, seconds: float, at_ns: int) -> None:
        flow = self.flows.get(sample.instance)
        if flow is None:
            flow = self.flows[sample.instance] = Flow(sample.seq, seconds)
        flow.hear(sample.seq, seconds)
        self.sample, self.heard_ns = sample, at_ns

    @property
    def lost(self) -> int:
        return sum(flow.lost for flow in self.flows.values())

    @property
    def rate(self) -> float | None:
        """Hz over the whole run."""
        took = sum(flow.took for flow in self.flows.values())
        return sum(flow.made for flow in self.flows.values()) / took if took > 0.0 else None

    def rate_now(self, seconds: float) -> float | None:
        return self.flows[self.sample.instance].rate_now(seconds)


class Telemetry:
    """Collects. Times are the robot's clock in ns."""

    def __init__(self, sensors: tuple[str, ...], truth: Truth) -> None:
        """`sensors`: names of the robot's ultrasonic sensors; `truth`: from before anything is heard."""
        self.truth = truth
        self._first_truth = truth
        self._sensors = sensors
        self._comparison = Comparison()
        self._ages = Ages()
        self._keys: dict[str, _Key] = {}
        self._alive: set[tuple[str, str]] = set()

    def hear(self, topic: Topic[Any], key: str, sample: Sample, at_ns: int) -> None:
        """A sample of `key` (below the robot's name), which `topic` is or stands for, heard at `at_ns`."""
        if key not in self._keys:
            self._keys[key] = _Key(topic)
        self._keys[key].hear(sample, self._clock(topic, at_ns), at_ns)
        if isinstance(sample, Odometry):
            self._comparison.hear(sample)
        elif isinstance(sample, GuardedCommand):
            self._note_age(sample, at_ns)

    def begin(self) -> None:
        """Judge rates and skew from now on: while processes start, nothing has its rate."""
        self._first_truth = self.truth
        for key in self._keys.values():
            for flow in key.flows.values():
                flow.begin()

    def see(self, truth: Truth) -> None:
        """The world's truth."""
        self.truth = truth
        self._comparison.see(truth)

    def announce(self, service: str, instance: str, *, present: bool) -> None:
        """A service's token on the network has come or gone."""
        if present:
            self._alive.add((service, instance))
        else:
            self._alive.discard((service, instance))

    @property
    def alive(self) -> frozenset[str]:
        """Services that are on the network."""
        return frozenset(service for service, _ in self._alive)

    @property
    def apart(self) -> Apart | None:
        """Odometry's error now."""
        return self._comparison.apart

    @property
    def lost(self) -> dict[str, int]:
        """By key, samples that their makers numbered and nobody here heard; keys that lost none are left out."""
        return {name: lost for name in self._names() if (lost := self._keys[name].lost)}

    @property
    def rates_hz(self) -> dict[str, float]:
        """By key, over the whole run."""
        return {name: rate for name in self._names() if (rate := self._keys[name].rate) is not None}

    @property
    def skew(self) -> float:
        """How much slower simulated time went than the wall's, as a share; negative: faster."""
        wall_us = (self.truth.robot_ns - self._first_truth.robot_ns) / 1000
        return 1.0 - (self.truth.simulated_us - self._first_truth.simulated_us) / wall_us if wall_us else 0.0

    @property
    def age_ms(self) -> AgeSummary | None:
        p50, p99, most = self._ages.share(0.5), self._ages.share(0.99), self._ages.share(1.0)
        return None if p50 is None or p99 is None or most is None else AgeSummary(p50, p99, most)

    def newest(self, topic: Topic[SampleT], now_ns: int) -> Seen[SampleT] | None:
        """The newest sample of a topic without `*`."""
        key = self._keys.get(topic.key)
        return None if key is None else Seen(key.sample, (now_ns - key.heard_ns) * 1e-9)

    def snapshot(self, now_ns: int) -> Snapshot:
        """Everything, as of now."""
        return Snapshot(
            truth=self.truth,
            true_pose=self._comparison.in_odom(self.truth.pose),
            apart=self.apart,
            odometry=self.newest(ODOM, now_ns),
            tilt=self.newest(TILT, now_ns),
            command=self.newest(CMD_VEL, now_ns),
            guard=self.newest(GUARD, now_ns),
            base=self.newest(BASE, now_ns),
            battery=self.newest(BATTERY, now_ns),
            estop=self.newest(ESTOP, now_ns),
            lease=self.newest(LEASE, now_ns),
            ranges={sensor: self.newest(RANGE.at(sensor), now_ns) for sensor in self._sensors},
            rates={name: self._rate(self._keys[name], now_ns) for name in self._names()},
            age_ms=self.age_ms,
            alive=self.alive,
        )

    def _names(self) -> list[str]:
        """The keys heard so far, in the order of the topics table."""
        return sorted(self._keys, key=lambda name: (_ORDER[self._keys[name].topic.key], name))

    def _rate(self, key: _Key, now_ns: int) -> KeyRate:
        return KeyRate(key.rate_now(self._clock(key.topic, now_ns)), key.topic.rate_hz, key.lost)

    def _clock(self, topic: Topic[Any], at_ns: int) -> float:
        """s of the clock that paces a topic. Simulated time runs on from the last look at it."""
        if topic.key in _BY_BOARD:
            return self.truth.simulated_us * 1e-6 + (at_ns - self.truth.robot_ns) * 1e-9
        return at_ns * 1e-9

    def _note_age(self, command: GuardedCommand, at_ns: int) -> None:
        tick = self.newest(TICK, at_ns)
        if tick is None or command.operator_tick is None or command.source != "hand":
            return
        if tick.sample.epoch == command.operator_tick.epoch:
            self._ages.add((at_ns - command.operator_tick.robot_ns) * 1e-6)
