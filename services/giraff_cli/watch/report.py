"""A live robot at one moment as a JSON object, for scripts. Its field names are kept."""

from __future__ import annotations

from typing import Any

import msgspec

from giraff_cli.watch.screen import WatchView, missing
from giraff_core.latest import Latest
from giraff_telemetry.collector import KeyRate
from giraff_telemetry.describe import base_text, limit_text, moving
from giraff_tools.terminal.text import json_line


class TopicReport(msgspec.Struct, frozen=True):
    """How a key flows."""

    hz: float | None
    """None: it does not."""
    lost: int
    """Samples that their makers numbered and that were not heard here."""
    age: float
    """s since the newest was heard."""


class WatchReport(msgspec.Struct, frozen=True, kw_only=True):
    """Samples have the fields of `giraff_schemas.messages` and `age`, s since they were heard. None: never heard."""

    robot: str
    elapsed: float
    """s since the watch began."""
    silence: float | None
    """s since anything was heard of the robot; None: nothing ever was."""
    waiting: str
    """What is waited for; empty once the robot was heard."""
    path: float | None
    """m."""
    speed: float | None
    """m/s; None: nothing tells it now."""
    turn: float | None
    """rad/s."""
    state: str
    """What base does, in a word or two."""
    why: str
    """What limits the robot now, with the way out; empty: nothing does."""
    missing: list[str]
    """The robot's own services that are not on the network."""
    services: dict[str, int]
    """How many of each are on the network."""
    odometry: dict[str, Any] | None
    ranges: dict[str, dict[str, Any] | None]
    lease: dict[str, Any] | None
    guard: dict[str, Any] | None
    base: dict[str, Any] | None
    estop: dict[str, Any] | None
    battery: dict[str, Any] | None
    localization: dict[str, Any] | None
    attitude: dict[str, Any] | None
    """None: it is no robot that balances."""
    cameras: dict[str, dict[str, Any] | None]
    """The cameras by name. `askers` see the picture now."""
    topics: dict[str, TopicReport]
    """By key, below the robot's name."""
    unreadable: tuple[str, ...]
    """What could not be decoded."""


class ReportView(WatchView):
    """Tells itself as a report."""

    def line(self) -> str:
        return json_line(report(self))


def report(view: WatchView) -> WatchReport:
    snapshot = view.snapshot
    path, speed, turn = moving(snapshot)
    return WatchReport(
        robot=view.robot,
        elapsed=round(view.elapsed, 3),
        silence=None if snapshot.silence is None else round(snapshot.silence, 3),
        waiting=view.waiting,
        path=path,
        speed=speed,
        turn=turn,
        state=base_text(snapshot),
        why=limit_text(snapshot),
        missing=missing(snapshot),
        services=snapshot.services,
        odometry=_sample(snapshot.odometry),
        ranges={sensor: _sample(seen) for sensor, seen in snapshot.ranges.items()},
        lease=_sample(snapshot.lease),
        guard=_sample(snapshot.guard),
        base=_sample(snapshot.base),
        estop=_sample(snapshot.estop),
        battery=_sample(snapshot.battery),
        localization=_sample(snapshot.localization),
        attitude=_sample(snapshot.attitude),
        cameras={camera: _sample(seen) for camera, seen in snapshot.cameras.items()},
        topics={key: _topic(rate) for key, rate in snapshot.rates.items()},
        unreadable=view.notices,
    )


def _sample(seen: Latest[Any] | None) -> dict[str, Any] | None:
    if seen is None:
        return None
    return {"age": round(seen.age, 3), **msgspec.to_builtins(seen.sample)}


def _topic(rate: KeyRate) -> TopicReport:
    hz = None if rate.hz is None else round(rate.hz, 1)
    return TopicReport(hz=hz, lost=rate.lost, age=round(rate.age, 3))
