"""The robot's state as ROS's diagnostics: a row for each part, by the newest sample of it."""

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, Final, NamedTuple

from rosbags.typesys.stores.ros2_kilted import diagnostic_msgs__msg__DiagnosticArray as DiagnosticArray
from rosbags.typesys.stores.ros2_kilted import diagnostic_msgs__msg__DiagnosticStatus as DiagnosticStatus
from rosbags.typesys.stores.ros2_kilted import diagnostic_msgs__msg__KeyValue as KeyValue

from giraff_core.latest import Latest, LatestSamples
from giraff_ros2.messages.header import header
from giraff_schemas import topics
from giraff_schemas.actions import ROS
from giraff_schemas.messages import BaseState, Battery, EStop, GuardState, Lease, Range
from giraff_schemas.topics import Topic

_OK, _WARN, _ERROR, _STALE = range(4)
_SILENT_REMEDY: Final = "run `giraff doctor` on the robot"


class _Row(NamedTuple):
    level: int
    message: str
    values: Mapping[str, object] = MappingProxyType({})


def diagnostics(stamp_ns: int, robot: str, newest: LatestSamples, now_ns: int) -> DiagnosticArray:
    """Return a row for each part. `robot`: its name; `now_ns`: of the clock by which `newest` has heard."""
    rows = {part: _row(newest.latest(topic, now_ns), tell) for part, topic, tell in _PARTS}
    guard = newest.latest(topics.GUARD, now_ns)
    doubts = (
        {name: each.trouble.line(ROS) for name, each in guard.sample.sensors.items()}
        if guard is not None and guard.fresh
        else {}
    )
    ranges: dict[str, Latest[Range]] = {}
    for each in newest.all(topics.RANGE, now_ns):
        ranges.setdefault(each.sample.sensor, each)
    for sensor in sorted({*ranges, *doubts}):
        row = _row(ranges[sensor], _range) if sensor in ranges else _Row(_OK, "trusted")
        if row.level == _OK and doubts.get(sensor):
            row = row._replace(level=_WARN, message=doubts[sensor])
        rows[f"sensor {sensor}"] = row
    return DiagnosticArray(
        header(stamp_ns, ""),
        [
            DiagnosticStatus(
                row.level,
                f"{robot}: {part}",
                row.message,
                robot,
                [KeyValue(key, _text(value)) for key, value in row.values.items()],
            )
            for part, row in rows.items()
        ],
    )


def _row(latest: Latest[Any] | None, tell: Callable[[Any], _Row]) -> _Row:
    if latest is None:
        return _Row(_STALE, f"nothing was heard of it; {_SILENT_REMEDY}")
    if latest.fresh:
        return tell(latest.sample)
    silent = f"nothing was heard of it for {latest.age:.0f} s; {_SILENT_REMEDY}"
    return tell(latest.sample)._replace(level=_STALE, message=silent)


def _base(state: BaseState) -> _Row:
    values = {
        "armed": state.armed,
        "driving": state.driving,
        "round trip (s)": state.round_trip,
        "budget left (s)": state.budget_left,
        "board": "connected" if state.board.connected else "not connected",
        "drive": state.board.drive_state,
        "refused": state.board.refused,
        "line errors": state.board.line_errors,
    }
    if not state.board.connected:
        return _Row(_ERROR, state.reason.line(ROS) or "the base board is not connected; plug in its cable", values)
    # A robot that nobody drives is well, and also has a reason why it does not move.
    return _Row(
        _WARN if state.reason and state.armed else _OK,
        state.reason.line(ROS) or ("armed" if state.armed else "not armed"),
        values,
    )


def _guard(state: GuardState) -> _Row:
    directions = {each: getattr(state, each) for each in ("forward", "backward", "turn_left", "turn_right")}
    values = {each: f"{verdict.clearance}, at most {verdict.allowed:.2f}" for each, verdict in directions.items()}
    return _Row(_WARN if state.reason and state.operator else _OK, state.reason.line(ROS) or "commands pass", values)


def _estop(stop: EStop) -> _Row:
    values = {"engaged": stop.engaged, "by": stop.by}
    if stop.engaged:
        return _Row(_ERROR, stop.reason.line(ROS) or f"engaged by {stop.by}", values)
    return _Row(_OK, "not engaged", values)


def _lease(lease: Lease) -> _Row:
    # The reason of a lease tells of the newest grant too, so that it is no warning.
    values = {"operator": lease.operator, "counter": lease.counter, "reason": lease.reason.line(ROS)}
    return _Row(_OK, f"{lease.operator} drives" if lease.holder else "free", values)


def _battery(battery: Battery) -> _Row:
    values = {"voltage (V)": battery.voltage, "since charge (s)": battery.since_charge}
    return _Row(_OK, f"{battery.voltage:.2f} V", values)


def _range(reading: Range) -> _Row:
    if reading.state == "fault":
        return _Row(_ERROR, reading.reason.line(ROS) or "the sensor has a fault", {"state": reading.state})
    return _Row(_OK, reading.state, {"state": reading.state, "range (m)": reading.range})


def _text(value: object) -> str:
    match value:
        case None:
            return "unknown"
        case bool():
            return "yes" if value else "no"
        case float():
            return f"{value:.3f}"
        case _:
            return str(value)


_PARTS: Final[tuple[tuple[str, Topic[Any], Callable[[Any], _Row]], ...]] = (
    ("base", topics.BASE, _base),
    ("guard", topics.GUARD, _guard),
    ("emergency stop", topics.ESTOP, _estop),
    ("lease", topics.LEASE, _lease),
    ("battery", topics.BATTERY, _battery),
)
