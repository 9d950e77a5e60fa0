"""A live robot at one moment, on 80 by 24 characters or wider, or in one line."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from giraff_core.latest import FRESH
from giraff_schemas.services import ROBOTS_OWN
from giraff_telemetry import panels as blocks
from giraff_telemetry.collector import Snapshot
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
    range_text,
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
            Text() if snapshot.localization is None else blocks.localization(snapshot),
            beside(blocks.ranges(snapshot), blocks.base(snapshot, ("e-stop", text_or_dash(estop_text(snapshot))))),
            blocks.balance(snapshot),
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
        "ranges " + " ".join(f"{range_text(seen):>6}" for seen in snapshot.ranges.values()),
        f"forward {forward_text(snapshot.guard)}",
        f"holder {holder_text(snapshot) or 'unknown'}",
        f"base {base_text(snapshot)}",
    ]
    told += [] if snapshot.attitude is None else [balance_text(snapshot)]
    told += [] if snapshot.localization is None else [f"map {localization_text(snapshot)}"]
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
