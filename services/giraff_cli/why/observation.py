"""What was heard of one robot for a moment. No clock, no network: both come in."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Final, Generic

from giraff_schemas.health import Health
from giraff_schemas.messages import RobotTime, Sample
from giraff_schemas.topics import TICK, SampleT, Topic

_LEAST: Final = 0.5  # s of silence that a busy machine or a short dropout does not explain
_PERIODS: Final = 3.0


@dataclass(frozen=True)
class Latest(Generic[SampleT]):
    """The newest sample of one maker on one key."""

    sample: SampleT
    age: float
    """s before the end of the listening."""


class Observation:
    """Samples, liveliness tokens and answers about health. Times are any one clock's ns."""

    def __init__(self, robot: str) -> None:
        self.robot = robot
        self.alive: dict[str, set[str]] = {}
        """Instances on the network, by service."""
        self.health: list[Health] = []
        self.now_ns = 0
        """The end of the listening."""
        self._newest: dict[tuple[str, str], tuple[Topic[Any], Sample, int]] = {}

    def on_sample(self, topic: Topic[Any], key: str, sample: Sample, at_ns: int) -> None:
        """A sample of `key` (below the robot's name), which `topic` is or stands for, heard at `at_ns`."""
        self._newest[key, sample.instance] = topic, sample, at_ns

    def on_liveliness(self, service: str, instance: str, *, present: bool) -> None:
        """A service's token on the network has come or gone."""
        instances = self.alive.setdefault(service, set())
        if present:
            instances.add(instance)
        else:
            instances.discard(instance)

    @property
    def empty(self) -> bool:
        """Whether there was nothing to hear."""
        return not self._newest and not any(self.alive.values())

    def of(self, topic: Topic[SampleT]) -> list[Latest[SampleT]]:
        """The newest sample of each key and maker that speaks of now, newest first."""
        longest = max(_LEAST, _PERIODS / topic.rate_hz if topic.rate_hz else math.inf)
        found: list[Latest[SampleT]] = [
            Latest(sample, (self.now_ns - at_ns) * 1e-9)  # type: ignore[arg-type]  # the topic tells the type
            for of, sample, at_ns in self._newest.values()
            if of.key == topic.key
        ]
        return sorted((heard for heard in found if heard.age <= longest), key=lambda heard: heard.age)

    def newest(self, topic: Topic[SampleT]) -> Latest[SampleT] | None:
        """The newest sample of a topic that speaks of now."""
        return next(iter(self.of(topic)), None)

    def age(self, heard: Latest[Any], moment: RobotTime | None) -> float:
        """s from `moment`, which `heard` carries, to when it was heard, by the robot's clock; inf: nothing tells."""
        tick = self.newest(TICK)
        if moment is None or tick is None or moment.epoch != tick.sample.epoch:
            return math.inf
        then_ns = tick.sample.robot_ns + (tick.age - heard.age) * 1e9
        return max(0.0, (then_ns - moment.robot_ns) * 1e-9)

    def faults(self, service: str) -> str:
        """What the processes of a service say is wrong, with them or elsewhere; empty: nothing, or no answer."""
        told = [health for health in self.health if health.service == service]
        return "; ".join(fault for health in told for fault in (*health.faults, *health.notices))
