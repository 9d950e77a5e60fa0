"""What is heard of a robot, made into what a person wants to know. No clock, no network: both come in."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from types import MappingProxyType
from typing import Any, Final

from giraff_core.latest import FRESH, Latest, LatestSamples
from giraff_core.senses import PUBLISHERS
from giraff_core.senses.heard import HeardSensor, heard_sensors
from giraff_schemas.camera import CameraState
from giraff_schemas.localization import MapPose
from giraff_schemas.messages import (
    Attitude,
    BaseState,
    Battery,
    EStop,
    GuardedCommand,
    GuardState,
    Lease,
    Odometry,
    Sample,
    Tilt,
    Wheels,
)
from giraff_schemas.places import RouteState
from giraff_schemas.services import SERVICES
from giraff_schemas.topics import (
    ATTITUDE,
    BASE,
    BATTERY,
    CAMERA_STATE,
    CMD_VEL,
    ESTOP,
    GUARD,
    LEASE,
    ODOM,
    POSE,
    ROUTE,
    TILT,
    TOPICS,
    WHEELS,
    Topic,
)
from giraff_telemetry.rate import RateEstimator, Totals

_ROUTE_FOR: Final = 30.0
"""s that a route is told of after its end, or after it was heard last."""
_ORDER: Final = {topic.key: number for number, topic in enumerate(TOPICS)}


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
    route: Latest[RouteState] | None
    """None: none goes on, or has ended just now."""
    attitude: Latest[Attitude] | None
    """None: it is no robot that balances."""
    sensed: dict[str, HeardSensor]
    """Sensors by name: first those that the guard knows of, in the order of the robot file."""
    cameras: dict[str, Latest[CameraState]]
    """By name."""
    rates: dict[str, KeyRate]
    """By key, in the order of the topics table."""
    services: dict[str, int]
    """By service, how many of it are on the network; 0: it was."""

    @property
    def unused(self) -> tuple[str, ...]:
        """Services that the robot does not need: its guard, by the robot file, knows no sensor that they tell of."""
        if self.guard is None or not self.guard.fresh:
            return tuple(service.name for service in SERVICES if service.extra_device)
        needed = {PUBLISHERS.get(kind) for kind in self.guard.sample.sensor_types.values()}
        return tuple(sorted({*PUBLISHERS.values()} - needed))


class _Key:
    """A key: a flow for each maker."""

    def __init__(self, topic: Topic[Any]) -> None:
        self.topic = topic
        self.flows: dict[str, RateEstimator] = {}
        self.newest: RateEstimator | None = None
        self.heard_ns = 0
        self._gone = Totals()

    def on_sample(self, sample: Sample, seconds: float, at_ns: int) -> None:
        flow = self.flows.get(sample.instance)
        if flow is None:
            self._retire(seconds)
            flow = self.flows[sample.instance] = RateEstimator(sample.seq, seconds)
        flow.on_sample(sample.seq, seconds)
        self.newest, self.heard_ns = flow, at_ns

    @property
    def lost(self) -> int:
        return self._totals.lost

    @property
    def rate(self) -> float | None:
        """Hz over the whole of it."""
        totals = self._totals
        return totals.made / totals.took if totals.took > 0.0 else None

    def rate_now(self, seconds: float) -> float | None:
        return self.newest.rate_now(seconds) if self.newest else None

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


class Telemetry(LatestSamples):
    """Collects. Times are this host's boot clock in ns."""

    def __init__(self, sensors: Mapping[str, str] = MappingProxyType({})) -> None:
        """`sensors`: the type of each sensor by name, as far as they are known before they are heard."""
        super().__init__()
        self._sensors = sensors
        self._keys: dict[str, _Key] = {}
        self._heard_ns: int | None = None
        self._route_ns: int | None = None
        """When a route was last heard that goes on."""

    def on_sample(self, topic: Topic[Any], key: str, sample: Sample, at_ns: int) -> None:
        super().on_sample(topic, key, sample, at_ns)
        if key not in self._keys:
            self._keys[key] = _Key(topic)
        self._keys[key].on_sample(sample, self._clock(topic, at_ns), at_ns)
        self._heard_ns = at_ns
        if isinstance(sample, RouteState) and sample.stage not in ("idle", "ended"):
            self._route_ns = at_ns

    def forget(self, topic: Topic[Any]) -> None:
        """Of a topic without `*` nothing is heard any more because nobody listens."""
        self._keys.pop(topic.key, None)
        self._heard.pop(topic.key, None)

    def begin(self) -> None:
        """Judge rates from now on: while processes start, nothing has its rate."""
        for key in self._keys.values():
            key.begin()

    @property
    def lost(self) -> dict[str, int]:
        """By key, samples that their makers numbered and nobody here heard; keys that lost none are left out."""
        return {name: lost for name in self._names() if (lost := self._keys[name].lost)}

    @property
    def rates_hz(self) -> dict[str, float]:
        """By key, over the whole time."""
        return {name: rate for name in self._names() if (rate := self._keys[name].rate) is not None}

    def snapshot(self, now_ns: int) -> Snapshot:
        """Everything, as of now."""
        guard = self.latest(GUARD, now_ns)
        route = self.latest(ROUTE, now_ns)
        is_told = self._route_ns is not None and _since(self._route_ns, now_ns) <= _ROUTE_FOR
        types = {**self._sensors, **(guard.sample.sensor_types if guard else {})}
        return Snapshot(
            silence=None if self._heard_ns is None else _since(self._heard_ns, now_ns),
            odometry=self.latest(ODOM, now_ns),
            wheels=self.latest(WHEELS, now_ns),
            tilt=self.latest(TILT, now_ns),
            command=self.latest(CMD_VEL, now_ns),
            guard=guard,
            base=self.latest(BASE, now_ns),
            battery=self.latest(BATTERY, now_ns),
            estop=self.latest(ESTOP, now_ns),
            lease=self.latest(LEASE, now_ns),
            localization=self.latest(POSE, now_ns),
            route=route if is_told and route is not None and route.sample.stage != "idle" else None,
            attitude=self.latest(ATTITUDE, now_ns),
            sensed=heard_sensors(types, partial(self.all, now_ns=now_ns)),
            cameras={heard.sample.camera: heard for heard in reversed(self.all(CAMERA_STATE, now_ns))},
            rates={name: self._rate(self._keys[name], now_ns) for name in self._names()},
            services={service: len(instances) for service, instances in self.instances.items()},
        )

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


def _since(then_ns: int, now_ns: int) -> float:
    return (now_ns - then_ns) * 1e-9
