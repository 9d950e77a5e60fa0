"""The live view: a snapshot as a picture of 80 by 24 characters, or wider."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Final, Literal

from rich.console import Group, RenderableType
from rich.rule import Rule
from rich.table import Column, Table
from rich.text import Text

from giraff_cli.line import base_text, range_text
from giraff_cli.motion import Pose
from giraff_cli.telemetry import KeyRate, Seen, Snapshot
from giraff_schemas.messages import Range, Verdict
from giraff_schemas.topics import RANGE

Standing = Literal["starting", "alive", "silent", "ended"]

_BAR: Final = 12  # characters
_BAR_REACH: Final = 3.0  # m that fill it
_TOPIC_COLUMNS: Final = 3
_FREEDOM: Final = {"free": "green", "slow": "yellow", "creep": "dark_orange", "blocked": "red"}
_STANDING: Final[dict[Standing, tuple[str, str]]] = {
    "starting": ("○", "dim"),
    "alive": ("●", "green"),
    "silent": ("○", "red"),
    "ended": ("✗", "bold red"),
}
_NONE: Final = Text("-", style="dim")


@dataclass(frozen=True, kw_only=True)
class Frame:
    """What is around the snapshot."""

    robot: str
    boards: str
    seed: int
    elapsed: float
    """s since the run began."""
    seconds: float | None
    """How long it is to go on; None: until Ctrl-C."""
    services: dict[str, Standing]
    notices: tuple[str, ...]
    """What went wrong so far, one line each."""


def view(snapshot: Snapshot, frame: Frame) -> RenderableType:
    """The picture."""
    parts: list[RenderableType] = [
        _header(frame),
        _beside(_poses(snapshot), _motion(snapshot), _hand(snapshot)),
        Text(),
        _beside(_ranges(snapshot), _base(snapshot)),
        Text(),
        _guard(snapshot),
        _command(snapshot),
        _topics(snapshot),
        _services(frame),
    ]
    parts += [Text(notice, style="red", no_wrap=True, overflow="ellipsis") for notice in frame.notices]
    return Group(*parts)


def _header(frame: Frame) -> RenderableType:
    clock = _clock(frame.elapsed)
    if frame.seconds is not None:
        clock += f" of {_clock(frame.seconds)}"
    title = Text.assemble(
        (f"giraff run · {frame.robot}", "bold"),
        (f" · {frame.boards} boards · seed {frame.seed} · ", "dim"),
        (clock, "bold"),
    )
    return Rule(title, style="cyan", align="left")


def _poses(snapshot: Snapshot) -> Table:
    table = _block("POSE", 8, _right("x m", 8), _right("y m", 8), _right("yaw °", 7))
    odometry, apart = snapshot.odometry, snapshot.apart
    believed = None if odometry is None else Pose(odometry.sample.x, odometry.sample.y, odometry.sample.yaw)
    table.add_row("odometry", *_pose(believed), style=_dim(odometry))
    table.add_row("truth", *_pose(snapshot.true_pose))
    if apart is None:
        table.add_row("apart", _NONE, "", _NONE)
    else:
        table.add_row("apart", f"{apart.distance:.3f}", "", f"{math.degrees(apart.angle):.1f}")
    return table


def _motion(snapshot: Snapshot) -> Table:
    table = _block("MOTION", 6, _right("", 6), _left("", 5))
    truth = snapshot.truth
    table.add_row("path", f"{truth.path:.2f}", _unit("m"))
    table.add_row("speed", f"{truth.speed:z.2f}", _unit("m/s"))
    table.add_row("turn", f"{truth.turn:z.2f}", _unit("rad/s"))
    return table


def _hand(snapshot: Snapshot) -> Table:
    tilt = snapshot.tilt
    table = _block("TILT", 7, _right("m/s²", 6))
    if tilt is not None and tilt.sample.status != "running":
        table.columns[1].header = Text(tilt.sample.status.replace("_", " "), style="red")
    for axis, meaning in (("x", "forward"), ("y", "left"), ("z", "up")):
        value = _NONE if tilt is None else f"{getattr(tilt.sample, axis):z.2f}"
        table.add_row(meaning, value, style=_dim(tilt))
    return table


def _ranges(snapshot: Snapshot) -> Table:
    longest = max((len(sensor) for sensor in snapshot.ranges), default=0)
    table = _block("RANGES", longest + 1, _right("", 6), _left("", _BAR), _right("Hz", 4))
    for sensor, seen in snapshot.ranges.items():
        rate = snapshot.rates.get(RANGE.at(sensor).key)
        table.add_row(sensor.replace("_", " "), range_text(seen), _bar(seen), _hz(rate))
    return table


def _bar(seen: Seen[Range] | None) -> Text:
    if seen is None or not seen.fresh or seen.sample.range is None:
        return Text("·" * _BAR, style="dim")
    distance = seen.sample.range
    filled = min(_BAR, max(1, round(distance / _BAR_REACH * _BAR)))
    style = "red" if distance < 0.3 else "yellow" if distance < 0.8 else "green"
    return Text.assemble(("█" * filled, style), ("·" * (_BAR - filled), "dim"))


def _base(snapshot: Snapshot) -> Table:
    table = _block("BASE", 7, _left("", 0))
    base, battery = snapshot.base, snapshot.battery
    word = base_text(snapshot)
    state = Text(word, style={"driving": "green", "silent": "red", "EMERGENCY STOP": "bold red"}.get(word, "yellow"))
    if battery is not None:
        state.append(f"  {battery.sample.voltage:.1f} V", style="default")
    table.add_row("state", state)
    reason = base.sample.reason if base is not None else ""
    table.add_row("reason", Text(reason, style="yellow") if reason else _NONE)
    age = snapshot.age_ms
    shown = _NONE if age is None else f"{age.p50:.0f} ms, p99 {age.p99:.0f}, most {age.max:.0f}"
    table.add_row("command", shown)
    return table


def _guard(snapshot: Snapshot) -> Table:
    table = _block("GUARD", 10, _right("allows", 6), _left("", 5), _left("", 7), _left("", 0))
    guard = snapshot.guard
    for name, unit in (("forward", "m/s"), ("backward", "m/s"), ("turn_left", "rad/s"), ("turn_right", "rad/s")):
        verdict: Verdict | None = None if guard is None else getattr(guard.sample, name)
        label = name.replace("_", " ")
        if verdict is None:
            table.add_row(label, _NONE, _unit(unit), _NONE, "")
            continue
        why = " · ".join(text for text in (verdict.reason, verdict.way_out) if text)
        freedom = Text(verdict.freedom, style=_FREEDOM[verdict.freedom])
        table.add_row(label, f"{verdict.allowed:.2f}", _unit(unit), freedom, why, style=_dim(guard))
    return table


def _command(snapshot: Snapshot) -> Table:
    """What passes the guard now, of whom, and why it is less than asked for."""
    command, lease = snapshot.command, snapshot.lease
    table = Table.grid(padding=(0, 1, 0, 0), expand=True)
    table.add_column(width=10, style="dim")
    table.add_column(no_wrap=True, overflow="ellipsis", ratio=1)
    if command is None or not command.fresh:
        table.add_row("passes", _NONE)
    else:
        sample = command.sample
        holder = "" if lease is None or not lease.fresh else lease.sample.operator or "nobody"
        text = Text(f"{sample.linear_x:z6.2f} m/s {sample.angular_z:z6.2f} rad/s  {holder}")
        table.add_row("passes", text.append(f"  {sample.reason}", style="yellow"))
    return table


def _topics(snapshot: Snapshot) -> Table:
    of_ranges = {RANGE.at(sensor).key for sensor in snapshot.ranges}
    rates = [(key, rate) for key, rate in snapshot.rates.items() if key not in of_ranges]
    lost = sum(rate.lost for rate in snapshot.rates.values())
    table = Table(box=None, padding=(0, 2, 0, 0), show_edge=False, pad_edge=False)
    heading = Text.assemble(("TOPICS", "bold cyan"), (f"  {lost} lost", "red" if lost else "dim"))
    for column in range(_TOPIC_COLUMNS):
        table.add_column(heading if column == 0 else "", no_wrap=True, overflow="ellipsis", width=17)
        table.add_column(_unit("Hz"), justify="right", no_wrap=True, width=5)
    rows = max(1, math.ceil(len(rates) / _TOPIC_COLUMNS))
    for row in range(rows):
        cells: list[RenderableType] = []
        for key, rate in rates[row::rows]:
            cells += [Text(key), _hz(rate)]
        table.add_row(*cells)
    return table


def _services(frame: Frame) -> Text:
    text = Text(no_wrap=True, overflow="ellipsis")
    text.append("SERVICES", style="bold cyan")
    for service, standing in frame.services.items():
        sign, style = _STANDING[standing]
        text.append("  ").append(f"{sign} ", style=style).append(service)
    return text


def _block(title: str, width: int, *columns: Column) -> Table:
    """A block of rows below a heading. Columns have fixed widths, so that nothing moves when a number grows."""
    label = Column(Text(title, style="bold cyan"), width=width, no_wrap=True, style="dim")
    expand = any(column.ratio for column in columns)
    return Table(label, *columns, box=None, padding=(0, 1, 0, 0), show_edge=False, pad_edge=False, expand=expand)


def _right(header: str, width: int) -> Column:
    return Column(_unit(header), width=width, justify="right", no_wrap=True)


def _left(header: str, width: int) -> Column:
    """`width` 0: whatever is left over."""
    return Column(_unit(header), width=width or None, ratio=None if width else 1, no_wrap=True, overflow="ellipsis")


def _unit(text: str) -> Text:
    return Text(text, style="dim")


def _beside(*blocks: Table) -> Table:
    grid = Table.grid(padding=(0, 3, 0, 0), expand=True)
    for _ in blocks[:-1]:
        grid.add_column()
    grid.add_column(ratio=1)
    grid.add_row(*blocks)
    return grid


def _pose(pose: Pose | None) -> tuple[RenderableType, RenderableType, RenderableType]:
    if pose is None:
        return _NONE, _NONE, _NONE
    return f"{pose.x:z.3f}", f"{pose.y:z.3f}", f"{math.degrees(pose.yaw):z.1f}"


def _hz(rate: KeyRate | None) -> Text:
    if rate is None or rate.hz is None:
        return Text("-", style="red")
    return Text(f"{rate.hz:.1f}", style="red" if rate.lost else "")


def _dim(seen: Seen[Any] | None) -> str:
    return "" if seen is not None and seen.fresh else "dim"


def _clock(seconds: float) -> str:
    return f"{int(seconds) // 60}:{int(seconds) % 60:02d}"
