"""A live robot at one moment: on 80 by 24 characters or wider, in one line, or as a JSON object for scripts."""

from dataclasses import dataclass
from typing import Any, Final

import msgspec
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from giraff_core.latest import FRESH, Latest
from giraff_core.senses import Ultrasonic
from giraff_core.senses.heard import HeardSensor
from giraff_schemas.services import ROBOTS_OWN
from giraff_telemetry import panels as blocks
from giraff_telemetry.collector import KeyRate, Snapshot
from giraff_telemetry.describe import (
    balance_text,
    base_text,
    battery_text,
    cameras_text,
    estop_text,
    forward_text,
    holder_text,
    limit_text,
    localization_text,
    moving,
    route_text,
    sensor_text,
    sensors_text,
)
from giraff_telemetry.layout import (
    NONE,
    ServiceStatus,
    beside,
    block,
    clock,
    header,
    left,
    notice,
    services,
    text_or_dash,
    why,
)
from giraff_telemetry.panels import dim
from giraff_tools.terminal.text import json_line

_TOPIC_COLUMNS: Final = 2
_NOTICES: Final = 1  # more would not fit 24 lines


def missing(snapshot: Snapshot) -> list[str]:
    """The robot's own services that are not on the network, but for those that it does not need."""
    return [each for each in ROBOTS_OWN if not snapshot.services.get(each) and each not in snapshot.unused]


@dataclass(frozen=True, kw_only=True)
class WatchView:
    """What is to be seen of a robot."""

    robot: str
    """Empty: nobody has named one, and none is there."""
    elapsed: float
    """s since the watch began."""
    snapshot: Snapshot
    waiting: str
    """What is waited for; empty once the robot was heard."""
    notices: tuple[str, ...] = ()
    """What cannot be read, one line each."""

    @property
    def silence(self) -> float | None:
        """s, where the robot has fallen silent."""
        silence = self.snapshot.silence
        return silence if silence is not None and silence > FRESH else None

    def render(self) -> RenderableType:
        if self.waiting:
            return Group(_header(self), Text(), text_or_dash(self.waiting, "yellow"))
        snapshot = self.snapshot
        return Group(
            _header(self),
            services(_statuses(snapshot)),
            beside(
                blocks.pose(snapshot),
                blocks.motion(*moving(snapshot), style=dim(snapshot.odometry)),
                _operator(snapshot),
            ),
            *(blocks.gap(snapshot) if snapshot.localization is None else [blocks.localization(snapshot)]),
            *blocks.route(snapshot),
            beside(blocks.ranges(snapshot), blocks.base(snapshot, ("e-stop", text_or_dash(estop_text(snapshot))))),
            *(blocks.gap(snapshot) if snapshot.attitude is None else [blocks.balance(snapshot)]),
            blocks.guard(snapshot),
            blocks.topics(snapshot, _TOPIC_COLUMNS, with_age=True),
            why(limit_text(snapshot)),
            *map(notice, self.notices[-_NOTICES:]),
        )

    def line(self) -> str:
        told = [self.waiting] if self.waiting else [_silent(self)] if self.silence is not None else _told(self.snapshot)
        return " | ".join([f"{self.elapsed:6.1f} s", *told, *self.notices[-_NOTICES:]])


def _told(snapshot: Snapshot) -> list[str]:
    path, speed, turn = ("-" if value is None else f"{value:z.2f}" for value in moving(snapshot))
    battery, gone, limit = snapshot.battery, missing(snapshot), limit_text(snapshot)
    told = [
        f"path {path:>6} m",
        f"{speed:>5} m/s {turn:>5} rad/s",
        sensors_text(snapshot),
        f"forward {forward_text(snapshot.guard)}",
        f"holder {holder_text(snapshot) or 'unknown'}",
        f"base {base_text(snapshot)}",
    ]
    told += [] if snapshot.attitude is None else [balance_text(snapshot)]
    told += [] if snapshot.localization is None else [f"map {localization_text(snapshot)}"]
    told += [] if snapshot.route is None else [f"route {route_text(snapshot)}"]
    told += [cameras] if (cameras := cameras_text(snapshot)) else []
    told += [] if battery is None else [battery_text(battery.sample)]
    told += [f"not there: {', '.join(gone)}"] if gone else []
    return [*told, limit] if limit else told


def _silent(view: WatchView) -> str:
    return f"{view.robot} silent since {view.silence:.0f} s"


def _header(view: WatchView) -> RenderableType:
    parts = [(f"giraff watch · {view.robot or 'any robot'} · ", "bold"), (clock(view.elapsed), "bold")]
    if cameras := cameras_text(view.snapshot):
        parts.append((f" · {cameras}", "bold yellow"))
    if view.silence is not None:
        parts.append((f" · silent since {view.silence:.0f} s", "bold red"))
    return header(*parts)


def _statuses(snapshot: Snapshot) -> list[tuple[str, ServiceStatus]]:
    found: list[tuple[str, ServiceStatus]] = []
    for service in dict.fromkeys((*ROBOTS_OWN, *sorted(snapshot.services))):
        count = snapshot.services.get(service, 0)
        found.append((service if count < 2 else f"{service} x{count}", "alive" if count else "silent"))
    return found


def _operator(snapshot: Snapshot) -> Table:
    """Who drives, why he or nobody does, and how old his command is when it reaches the board."""
    table = block("OPERATOR", 8, left("", 0))
    lease, base = snapshot.lease, snapshot.base
    table.add_row("holder", text_or_dash(holder_text(snapshot)))
    table.add_row("lease", text_or_dash("" if lease is None else str(lease.sample.reason)), style=dim(lease))
    age: RenderableType = NONE
    if base is not None and base.fresh and base.sample.round_trip is not None:
        left_over = base.sample.budget_left
        age = f"{base.sample.round_trip * 1000.0:.0f} ms old"
        age += "" if left_over is None else f", {left_over * 1000.0:.0f} ms left"
    table.add_row("command", age)
    return table


class TopicReport(msgspec.Struct, frozen=True):
    """How a key flows."""

    hz: float | None
    """None: it does not."""
    lost: int
    """Samples that their makers numbered and that were not heard here."""
    age: float
    """s since the newest was heard."""


class WatchReport(msgspec.Struct, frozen=True, kw_only=True):
    """Samples have the fields of `giraff_schemas.messages` and `age`, s since they were heard. None: never heard.

    Its own field names are kept.
    """

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
    """Newest sample of each ultrasonic sensor."""
    sensed: dict[str, dict[str, Any]]
    """All sensors by name: `type`, `text` in a word, `nearest` (m, 0 where it touches) and `age` (s)."""
    lease: dict[str, Any] | None
    guard: dict[str, Any] | None
    base: dict[str, Any] | None
    estop: dict[str, Any] | None
    battery: dict[str, Any] | None
    localization: dict[str, Any] | None
    route: dict[str, Any] | None
    """None: none goes on, and none has ended within 30 s."""
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
        ranges={name: _sample(each.newest) for name, each in snapshot.sensed.items() if each.sense is Ultrasonic},
        sensed={name: _sensor(each) for name, each in snapshot.sensed.items()},
        lease=_sample(snapshot.lease),
        guard=_sample(snapshot.guard),
        base=_sample(snapshot.base),
        estop=_sample(snapshot.estop),
        battery=_sample(snapshot.battery),
        localization=_sample(snapshot.localization),
        route=_sample(snapshot.route),
        attitude=_sample(snapshot.attitude),
        cameras={camera: _sample(seen) for camera, seen in snapshot.cameras.items()},
        topics={key: _topic(rate) for key, rate in snapshot.rates.items()},
        unreadable=view.notices,
    )


def _sample(seen: Latest[Any] | None) -> dict[str, Any] | None:
    if seen is None:
        return None
    return {"age": round(seen.age, 3), **msgspec.to_builtins(seen.sample)}


def _sensor(sensor: HeardSensor) -> dict[str, Any]:
    nearest = None if sensor.summary is None else sensor.summary.nearest
    age = None if sensor.newest is None else round(sensor.newest.age, 3)
    return {"type": sensor.sense.type_name(), "text": sensor_text(sensor), "nearest": nearest, "age": age}


def _topic(rate: KeyRate) -> TopicReport:
    hz = None if rate.hz is None else round(rate.hz, 1)
    return TopicReport(hz=hz, lost=rate.lost, age=round(rate.age, 3))
