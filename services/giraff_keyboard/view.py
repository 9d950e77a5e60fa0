"""Collects what a person who drives is shown."""

from __future__ import annotations

from typing import Any

from giraff_core.latest import Latest
from giraff_core.operator import what_stops
from giraff_keyboard.picture import DrivePicture
from giraff_keyboard.policy import KeyboardPolicy
from giraff_schemas.topics import BASE, BATTERY, ESTOP, GUARD, ODOM, RANGE, SampleT, Topic
from giraff_schemas.trouble import Trouble
from giraff_telemetry.collector import Telemetry


class DriveView:
    """Times are monotonic, s."""

    topics: tuple[Topic[Any], ...] = (BASE, GUARD, ESTOP, BATTERY, ODOM, RANGE)

    def __init__(self, robot: str, sensors: tuple[str, ...]) -> None:
        """`sensors`: of the robot, in the order of its file."""
        self._robot = robot
        self._telemetry = Telemetry(sensors)
        self.on_sample = self._telemetry.add
        self._began: float | None = None

    def draw(self, policy: KeyboardPolicy, stop: Trouble, now: float) -> DrivePicture:
        """What is to be seen now. `stop`: what became of a stop, or of its release, that was asked for here."""
        self._began = now if self._began is None else self._began
        snapshot = self._telemetry.snapshot(_ns(now))
        return DrivePicture(
            robot=self._robot,
            elapsed=now - self._began,
            snapshot=snapshot,
            is_lost=policy.moment(now) is None,
            is_mine=policy.operator.holds,
            driver=policy.operator.holder,
            why=what_stops(policy.trouble(now), _fresh(snapshot.base), _fresh(snapshot.guard))
            or policy.operator.rank_notice,
            stop=stop,
            step=policy.step,
            steps=policy.steps,
            speed=policy.speed,
        )


def _fresh(seen: Latest[SampleT] | None) -> SampleT | None:
    return seen.sample if seen is not None and seen.fresh else None


def _ns(seconds: float) -> int:
    return round(seconds * 1e9)
