"""What was heard of one robot for a moment. No clock, no network: both come in."""

from __future__ import annotations

import math
from typing import Any, Final

from giraff_core.latest import Latest, LatestSamples
from giraff_schemas.health import Health
from giraff_schemas.messages import RobotTime
from giraff_schemas.topics import TICK, SampleT, Topic
from giraff_schemas.trouble import Trouble

_LEAST: Final = 0.5  # s of silence that a busy machine or a short dropout does not explain
_PERIODS: Final = 3.0


class Observation(LatestSamples):
    """Samples, liveliness tokens and answers about health. Times are any one clock's ns."""

    def __init__(self, robot: str, host: str = "", version: str = "") -> None:
        """`host`, `version`: of the command that listens."""
        super().__init__()
        self.robot, self.host, self.version = robot, host, version
        self.health: list[Health] = []
        self.hung: frozenset[str] = frozenset()
        """Services that were asked by their own name and did not answer in time."""
        self.now_ns = 0
        """The end of the listening."""

    @property
    def empty(self) -> bool:
        """Whether there was nothing to hear."""
        return not self._heard and not self.alive

    def of(self, topic: Topic[SampleT]) -> list[Latest[SampleT]]:
        """The newest sample of each key and maker that speaks of now, newest first."""
        longest = max(_LEAST, _PERIODS / topic.rate_hz if topic.rate_hz else math.inf)
        return [heard for heard in self.all(topic, self.now_ns) if heard.age <= longest]

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

    @property
    def unanswered(self) -> frozenset[str]:
        """Services that are on the network and have not answered."""
        return self.alive - {health.service for health in self.health}

    def versions(self, service: str) -> tuple[str, ...]:
        """Return the versions of a service's processes; nothing without an answer."""
        return tuple(health.version for health in self.health if health.service == service)

    def faults(self, service: str) -> tuple[Trouble, ...]:
        """Return what the processes of a service say is wrong, with them or elsewhere; nothing without an answer."""
        told = [health for health in self.health if health.service == service]
        return tuple(fault for health in told for fault in (*health.faults, *health.notices))
