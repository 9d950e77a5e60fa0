"""The blocks of a live view that tell of any robot, simulated or not."""

import math
from collections.abc import Sequence
from typing import Any, Final

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from giraff_core.latest import Latest
from giraff_core.senses.heard import HeardSensor
from giraff_schemas.text import printable
from giraff_schemas.topics import (
    ATTITUDE,
    CAMERA_ON,
    CAMERA_STATE,
    MAP,
    MOTION,
    MOTION_HOLD,
    PARTICLES,
    PLACES,
    PLACES_HOLD,
    POSE,
    ROUTE,
    VISUAL_ODOM,
    covers,
)
from giraff_schemas.wire import RANGE_SENSORS
from giraff_telemetry.collector import KeyRate, Snapshot
from giraff_telemetry.describe import (
    DIRECTIONS,
    balance_text,
    base_reason,
    base_text,
    battery_text,
    holder_text,
    localization_text,
    route_text,
    sensor_text,
    verdicts,
)
from giraff_telemetry.layout import HEADING, NONE, block, left, right, text_or_dash, unit

_BAR: Final = 12  # characters
_BAR_REACH: Final = 3.0  # m that fill it
_LONGEST_SENSOR: Final = 14  # characters
_LEFT_OUT: Final = (
    *(MOTION, MOTION_HOLD, POSE, PARTICLES, MAP, PLACES, PLACES_HOLD, ROUTE, ATTITUDE, CAMERA_ON, CAMERA_STATE),
    VISUAL_ODOM,
)
CLEARANCE_STYLE: Final = {"free": "green", "slow": "yellow", "creep": "dark_orange", "blocked": "red"}
_STATES: Final = {"localized": "green", "told": "yellow", "ambiguous": "yellow", "lost": "yellow", "no_map": "red"}
_BASE: Final = {"driving": "green", "silent": "red", "EMERGENCY STOP": "bold red"}


def pose(snapshot: Snapshot) -> Table:
    """Where odometry has it."""
    table = block("POSE", 4, right("", 8), left("", 1))
    odometry = snapshot.odometry
    pose = (None, None, None) if odometry is None else (odometry.sample.x, odometry.sample.y, odometry.sample.yaw)
    x, y, yaw = pose
    table.add_row("x", NONE if x is None else f"{x:z.3f}", unit("m"), style=dim(odometry))
    table.add_row("y", NONE if y is None else f"{y:z.3f}", unit("m"), style=dim(odometry))
    table.add_row("yaw", NONE if yaw is None else f"{math.degrees(yaw):z.1f}", unit("°"), style=dim(odometry))
    return table


def motion(path: float | None, speed: float | None, turn: float | None, style: str = "") -> Table:
    """Path travelled (m), velocity now (m/s, rad/s)."""
    table = block("MOTION", 6, right("", 6), left("", 5))
    for label, value, of in (("path", path, "m"), ("speed", speed, "m/s"), ("turn", turn, "rad/s")):
        table.add_row(label, NONE if value is None else f"{value:z.2f}", unit(of), style=style)
    return table


def ranges(snapshot: Snapshot) -> Table:
    """What each sensor sees, and how often."""
    longest = max((len(name) for name in snapshot.sensed), default=0)
    table = block("RANGES", min(longest, _LONGEST_SENSOR) + 1, right("", 6), left("", _BAR), right("Hz", 4))
    for name, sensor in snapshot.sensed.items():
        rate = snapshot.rates.get(sensor.key)
        table.add_row(text_or_dash(name.replace("_", " ")), sensor_text(sensor), _bar(sensor), _hz(rate))
    return table


def gap(snapshot: Snapshot) -> list[Text]:
    """Return a blank row; none where the guard names so many sensors that they need it."""
    named = snapshot.guard.sample.sensors if snapshot.guard else ()
    return [] if len(named) > RANGE_SENSORS else [Text()]


def base(snapshot: Snapshot, *rows: tuple[str, RenderableType]) -> Table:
    """Base, why it does not do what is asked, and whatever else the view tells beside it."""
    table = block("BASE", 7, left("", 0))
    word = base_text(snapshot)
    state = Text(printable(word), style=_BASE.get(word, "yellow"))
    if snapshot.battery is not None:
        state.append(f"  {battery_text(snapshot.battery.sample)}", style=f"default {dim(snapshot.battery)}")
    table.add_row("state", state)
    table.add_row("reason", text_or_dash(base_reason(snapshot), "yellow"))
    for row in rows:
        table.add_row(*row)
    return table


def guard(snapshot: Snapshot) -> Table:
    """The verdict for each direction."""
    table = block("GUARD", 10, right("allows", 6), left("", 5), left("", 7), left("", 0))
    seen = snapshot.guard
    if seen is None:
        for label in DIRECTIONS:
            table.add_row(label, NONE, _speed_unit(label), NONE, "")
        return table
    for label, verdict in verdicts(seen.sample):
        why = printable(str(verdict.reason))
        clearance = Text(verdict.clearance, style=CLEARANCE_STYLE[verdict.clearance])
        table.add_row(label, f"{verdict.allowed:.2f}", _speed_unit(label), clearance, Text(why), style=dim(seen))
    return table


def command(snapshot: Snapshot) -> Table:
    """What passes the guard now, of whom, and why it is less than asked for."""
    seen = snapshot.command
    table = Table.grid(padding=(0, 1, 0, 0), expand=True)
    table.add_column(width=10, style="dim")
    table.add_column(no_wrap=True, overflow="ellipsis", ratio=1)
    if seen is None or not seen.fresh:
        table.add_row("passes", NONE)
    else:
        sample, holder = seen.sample, printable(holder_text(snapshot))
        text = Text(f"{sample.linear_x:z6.2f} m/s {sample.angular_z:z6.2f} rad/s  {holder}")
        table.add_row("passes", text.append(f"  {printable(str(sample.reason))}", style="yellow"))
    return table


def topics(snapshot: Snapshot, columns: int, *, with_age: bool = False) -> Table:
    """How each key flows, but for some services that not all robots have: with more rows it is no longer 24 high."""
    shown = {sensor.key for sensor in snapshot.sensed.values()}
    rates = [
        (key, rate)
        for key, rate in snapshot.rates.items()
        if key not in shown and not any(covers(topic, key) for topic in _LEFT_OUT)
    ]
    lost = sum(rate.lost for rate in snapshot.rates.values())
    losing = any(rate.losing for rate in snapshot.rates.values())
    table = Table(box=None, padding=(0, 2, 0, 0), show_edge=False, pad_edge=False)
    heading = Text.assemble(("TOPICS", HEADING), (f"  {lost} lost", "red" if losing else "yellow" if lost else "dim"))
    for column in range(columns):
        table.add_column(heading if column == 0 else "", no_wrap=True, overflow="ellipsis", width=17)
        table.add_column(unit("Hz"), justify="right", no_wrap=True, width=5)
        if with_age:
            table.add_column(unit("age s"), justify="right", no_wrap=True, width=7)
    rows = max(1, math.ceil(len(rates) / columns))
    for row in range(rows):
        table.add_row(*_cells(rates[row::rows], with_age=with_age))
    return table


def localization(snapshot: Snapshot, more: str = "") -> Text:
    """Where it is on the map, in a row; `more` goes before its words."""
    seen = snapshot.localization
    style = _STATES[seen.sample.state] if seen is not None and seen.fresh else "dim"
    text = Text.assemble(("MAP  ", HEADING), no_wrap=True, overflow="ellipsis")
    if more:
        text.append(f"{printable(more)}  ")
    return text.append_text(text_or_dash(localization_text(snapshot), style))


def route(snapshot: Snapshot) -> list[Text]:
    """Return the row of a route that goes on, or has ended just now; nothing where there is none."""
    if (seen := snapshot.route) is None:
        return []
    state = seen.sample
    style = "dim" if not seen.fresh else "green" if state.stage == "moving" or state.outcome == "arrived" else "yellow"
    text = Text.assemble(("ROUTE  ", HEADING), no_wrap=True, overflow="ellipsis")
    return [text.append_text(text_or_dash(route_text(snapshot), style))]


def balance(snapshot: Snapshot) -> Text:
    """How a robot that balances holds itself, in a row; blank for others."""
    seen = snapshot.attitude
    if seen is None:
        return Text()
    style = "dim" if not seen.fresh else "green" if seen.sample.posture == "stands" else "yellow"
    text = Text.assemble(("BALANCE  ", HEADING), no_wrap=True, overflow="ellipsis")
    return text.append_text(text_or_dash(balance_text(snapshot), style))


def dim(seen: Latest[Any] | None) -> str:
    """The style of what may be over."""
    return "" if seen is not None and seen.fresh else "dim"


def _cells(rates: Sequence[tuple[str, KeyRate]], *, with_age: bool) -> list[RenderableType]:
    cells: list[RenderableType] = []
    for key, rate in rates:
        cells += [text_or_dash(key), _hz(rate)]
        if with_age:
            cells.append(Text(f"{rate.age:.2f}" if rate.fresh else f"{rate.age:.0f}", "" if rate.fresh else "red"))
    return cells


def _speed_unit(direction: str) -> Text:
    return unit("rad/s" if direction.startswith("turn") else "m/s")


def _bar(sensor: HeardSensor) -> Text:
    if sensor.summary is None or (distance := sensor.summary.nearest) is None:
        return Text("·" * _BAR, style="dim")
    filled = max(1, round(min(distance, _BAR_REACH) / _BAR_REACH * _BAR))
    style = "red" if distance < 0.3 else "yellow" if distance < 0.8 else "green"
    return Text.assemble(("█" * filled, style), ("·" * (_BAR - filled), "dim"))


def _hz(rate: KeyRate | None) -> Text:
    if rate is None or rate.hz is None:
        return Text("-", style="red")
    return Text(f"{rate.hz:.1f}", style="red" if rate.losing else "")
