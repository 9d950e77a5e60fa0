"""`giraff topic list` and `info`: what is said on a robot's network, by whom, and to whom."""

from collections.abc import Mapping, Sequence
from typing import Any, Final

import msgspec
import zenoh

from giraff_schemas.fields import Field, fields_of
from giraff_schemas.messages import Sample
from giraff_schemas.topics import CAMERA_PICTURES, TOPICS, Qos, Topic, key_of, topic_of
from giraff_tools.network.command import print_error, run_with_robot
from giraff_tools.network.connection import RobotConnection
from giraff_tools.network.robot_graph import GraphMonitor, NodeId, RobotGraph, is_listened_to, names_of
from giraff_tools.network.topic_keys import (
    UnknownKeyError,
    below_robot,
    find_heard_topic,
    find_topic,
    intersects,
    is_declared,
)
from giraff_tools.terminal.page import print_json, print_table, shown
from giraff_tools.terminal.signals import StopSignal

QOS: Final[Mapping[Qos, str]] = {
    "control": "real-time priority, sent at once; dropped rather than late",
    "state": "high priority; dropped rather than late",
    "bulk": "lowest priority, in a session of its own; dropped rather than late",
}


class TopicRow(msgspec.Struct, frozen=True, kw_only=True):
    """A key, as it is now."""

    key: str
    type: str
    """Of its samples; empty: the topics table has no such key."""
    nominal_hz: float
    """0: on change only."""
    hz: float | None
    """By the maker's own numbers and stamps; None: too little was heard."""
    heard: int
    """Samples."""
    publishers: list[NodeId]
    subscribers: list[NodeId]


class TopicInfo(msgspec.Struct, frozen=True, kw_only=True):
    """All that is known of a key."""

    row: TopicRow
    robot: str
    whole_key: str
    qos: str
    matching: bool
    """Zenoh knows of a subscriber: one of those named, or one that names itself nowhere."""
    fields: tuple[Field, ...]
    parts: dict[str, tuple[Field, ...]]
    """Structs that a field's type names."""


def list_topics(robot: str | None, connect: Sequence[str], seconds: float, *, with_absent: bool, as_json: bool) -> int:
    """Print the keys of a robot, `with_absent` those of the table that nobody publishes, too; the exit code."""
    with StopSignal() as stopping:
        return run_with_robot(
            robot, connect, lambda met: _list(met, stopping, seconds, with_absent=with_absent, as_json=as_json)
        )


def info(key: str, robot: str | None, connect: Sequence[str], seconds: float, *, as_json: bool) -> int:
    """Print what a key is, and what it does now; the exit code."""
    try:
        key, robot = below_robot(key, robot)
        topic = find_topic(key) if topic_of(key) in CAMERA_PICTURES else find_heard_topic(key)
    except UnknownKeyError as error:
        return print_error(str(error))
    with StopSignal() as stopping:
        return run_with_robot(robot, connect, lambda met: _info(met, stopping, topic, seconds, as_json=as_json))


def rows_of(robot_graph: RobotGraph, *, with_absent: bool) -> list[TopicRow]:
    """Every key that is published or heard; `with_absent` each of the table that is not, too."""
    keys = robot_graph.keys
    absent = [topic.key for topic in TOPICS if with_absent and not any(intersects(topic.key, key) for key in keys)]
    order = {topic.key: number for number, topic in enumerate(TOPICS)}
    rows = [_row(robot_graph, key) for key in (*keys, *absent)]
    return sorted(rows, key=lambda row: order.get(getattr(topic_of(row.key), "key", ""), len(order)))


def _list(
    connection: RobotConnection, stopping: StopSignal, seconds: float, *, with_absent: bool, as_json: bool
) -> int:
    robot_graph = GraphMonitor.counting(connection).run(seconds, stopping)
    rows = rows_of(robot_graph, with_absent=with_absent)
    if as_json:
        print_json(rows)
        return 0
    print_table(
        ("key", "type", ">nominal Hz", ">Hz now", "published by", "listened to by"),
        (
            (
                row.key,
                row.type or "a maker's",
                _nominal(row),
                shown(row.hz) if row.hz is not None else "heard" if row.heard else _unheard(row),
                names_of(row.publishers) or ("?" if row.heard else "nobody"),
                names_of(row.subscribers),
            )
            for row in rows
        ),
    )
    return 0


def _info(
    connection: RobotConnection, stopping: StopSignal, topic: Topic[Any], seconds: float, *, as_json: bool
) -> int:
    key = key_of(connection.robot, topic)
    speaker = connection.session.declare_publisher(
        key, allowed_destination=zenoh.Locality.REMOTE
    )  # this one is no news
    robot_graph = GraphMonitor.counting(connection, topic).run(seconds, stopping)
    if missing := robot_graph.instead(topic):
        return print_error(missing)
    found = TopicInfo(
        row=_row(robot_graph, topic.key),
        robot=connection.robot,
        whole_key=key,
        qos=QOS[topic.qos] if is_declared(topic) else "as its maker publishes it",
        matching=is_listened_to(speaker),
        fields=fields_of(topic.schema) if is_declared(topic) else (),
        parts=_parts(topic.schema) if is_declared(topic) else {},
    )
    if as_json:
        print_json(found)
    else:
        _show(found)
    return 0


def _show(found: TopicInfo) -> None:
    row = found.row
    nominal = f"{_nominal(row)}{' Hz' if row.nominal_hz else ''} by the table; " if row.type else ""
    silent = "none by which to tell the rate" if row.heard else _unheard(row)
    listeners = names_of(row.subscribers)
    if not listeners:
        listeners = "somebody whose health does not tell" if found.matching else "nobody"
    lines = (
        ("key", found.whole_key),
        ("type", row.type or "a maker's: giraff topic echo shows what it carries"),
        ("rate", f"{nominal}now {f'{shown(row.hz)} Hz' if row.hz is not None else silent}"),
        ("quality", found.qos),
        ("published by", names_of(row.publishers, instances=True) or ("?" if row.heard else "nobody now")),
        ("listened to by", listeners),
    )
    print_table(("", ""), lines)
    for title, fields in ((row.type, found.fields), *found.parts.items()) if row.type else ():
        print()
        print_table((title, "", ""), ((field.name, field.type, field.doc) for field in fields))


def _nominal(row: TopicRow) -> str:
    """Return its rate by the table."""
    return "-" if not row.type else shown(row.nominal_hz) if row.nominal_hz else "on change"


def _row(robot_graph: RobotGraph, key: str) -> TopicRow:
    """Of a key, or of all that one with a `*` covers."""
    covered = [other for other in robot_graph.keys if intersects(key, other)]
    counts = [
        count for other in covered if other in robot_graph.topics for count in robot_graph.topics[other].counts.values()
    ]
    row = topic_of(key)
    rates = [rate for count in counts if (rate := count.rate) is not None]
    if row is None and not counts:  # its maker numbers nothing
        came = (robot_graph.topics[other].arrival_rate for other in covered if other in robot_graph.topics)
        rates = [rate for rate in came if rate is not None]
    return TopicRow(
        key=key,
        type="" if row is None else row.schema.__name__,
        nominal_hz=0.0 if row is None else row.rate_hz,
        hz=sum(rates) / len(rates) if rates else None,
        heard=sum(robot_graph.topics[other].samples for other in covered if other in robot_graph.topics),
        publishers=sorted({maker for other in covered for maker in robot_graph.publishers(other)}),
        subscribers=robot_graph.subscribers(key),
    )


def _unheard(row: TopicRow) -> str:
    """Why it has no rate: pictures are sent to those alone who have asked for them."""
    return "unasked" if topic_of(row.key) in CAMERA_PICTURES else "silent"


def _parts(schema: type[msgspec.Struct]) -> dict[str, tuple[Field, ...]]:
    """The Structs within a Struct, by name."""
    found: dict[str, tuple[Field, ...]] = {}
    _, components = msgspec.json.schema_components([schema])
    for struct in msgspec.Struct.__subclasses__():
        if struct.__name__ in components and struct is not schema and not issubclass(struct, Sample):
            found[struct.__name__] = fields_of(struct)
    return found
