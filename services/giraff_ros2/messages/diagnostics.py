"""The robot's state as ROS's diagnostics: a row for each part, by the newest sample of it."""

from collections.abc import Callable, Mapping
from functools import partial
from types import MappingProxyType
from typing import Any, Final, NamedTuple

from rosbags.typesys.stores.ros2_kilted import diagnostic_msgs__msg__DiagnosticArray as DiagnosticArray
from rosbags.typesys.stores.ros2_kilted import diagnostic_msgs__msg__DiagnosticStatus as DiagnosticStatus
from rosbags.typesys.stores.ros2_kilted import diagnostic_msgs__msg__KeyValue as KeyValue

from giraff_core.latest import Latest, LatestSamples
from giraff_core.senses import Sense
from giraff_core.senses.heard import heard_sensors
from giraff_ros2.messages.header import header
from giraff_schemas import topics
from giraff_schemas.actions import ROS
from giraff_schemas.messages import BaseState, Battery, EStop, GuardState, Lease
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
    judged = guard.sample.sensors if guard is not None and guard.fresh else {}
    types = {name: each.type for name, each in judged.items()}
    for name, sensor in heard_sensors(types, partial(newest.all, now_ns=now_ns)).items():
        row = _row(sensor.newest, partial(_sensor, sensor.sense)) if sensor.newest else _Row(_OK, "trusted")
        if row.level == _OK and name in judged and (doubt := judged[name].trouble):
            row = row._replace(level=_WARN, message=doubt.line(ROS))
        rows[f"sensor {name}"] = row
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


def _sensor(sense: type[Sense], sample: Any) -> _Row:
    text, nearest, trouble = sense.summary(sample)
    values = {"state": text, "nearest (m)": nearest}
    return _Row(_ERROR, trouble.line(ROS), values) if trouble else _Row(_OK, text, values)


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
