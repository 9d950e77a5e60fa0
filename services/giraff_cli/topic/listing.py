"""`giraff topic list` and `info`: what is said on a robot's network, by whom, and to whom."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

import msgspec
import zenoh
from rich.text import Text

from giraff_cli.network.command import complain, visit
from giraff_cli.network.connection import Watcher
from giraff_cli.network.header_subscriber import Meter
from giraff_cli.network.robot_graph import Maker, Survey, Surveyor, is_listened_to
from giraff_cli.network.topic_keys import UnknownKeyError, covers, find_topic
from giraff_cli.terminal.page import Page, print_json, print_table, shown
from giraff_cli.terminal.signals import Stopping
from giraff_cli.terminal.text import printable
from giraff_schemas.fields import Field, fields_of
from giraff_schemas.messages import Sample
from giraff_schemas.topics import TOPICS, Topic, key_of, topic_of

_PATIENCE: Final = 3.0  # s, to find the only robot
_QOS: Final = {
    "control": "real-time priority, sent at once; dropped rather than late",
    "state": "high priority; dropped rather than late",
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
    publishers: list[Maker]
    subscribers: list[Maker]


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


def list_topics(robot: str | None, connect: Sequence[str], seconds: float, *, as_json: bool) -> int:
    """Print the keys of a robot; the exit code."""
    with Stopping() as stopping:
        return visit(robot, connect, _PATIENCE, lambda watcher: _list(watcher, stopping, seconds, as_json=as_json))


def info(key: str, robot: str | None, connect: Sequence[str], seconds: float, *, as_json: bool) -> int:
    """Print what a key is, and what it does now; the exit code."""
    try:
        topic = find_topic(key)
    except UnknownKeyError as error:
        return complain(str(error))
    with Stopping() as stopping:
        return visit(
            robot, connect, _PATIENCE, lambda watcher: _info(watcher, stopping, topic, seconds, as_json=as_json)
        )


def rows_of(survey: Survey) -> list[TopicRow]:
    """Every key that is there, and each of the table that is not."""
    keys = survey.keys
    absent = [topic.key for topic in TOPICS if not any(covers(topic.key, key) for key in keys)]
    order = {topic.key: number for number, topic in enumerate(TOPICS)}
    rows = [_row(survey, key) for key in (*keys, *absent)]
    return sorted(rows, key=lambda row: order.get(getattr(topic_of(row.key), "key", ""), len(order)))


def _list(watcher: Watcher, stopping: Stopping, seconds: float, *, as_json: bool) -> int:
    survey = Surveyor(watcher, [Meter(watcher.session, watcher.robot)]).go(seconds, stopping)
    rows = rows_of(survey)
    if as_json:
        print_json(rows)
        return 0
    print_table(
        ("key", "type", ">nominal Hz", ">Hz now", "published by", "listened to by"),
        (
            (
                row.key,
                row.type or "not in the table",
                shown(row.nominal_hz) if row.nominal_hz else "on change",
                shown(row.hz) if row.hz is not None else "heard" if row.heard else "silent",
                _names(row.publishers) or "nobody",
                _names(row.subscribers),
            )
            for row in rows
        ),
    )
    return 0


def _info(watcher: Watcher, stopping: Stopping, topic: Topic[Any], seconds: float, *, as_json: bool) -> int:
    key = key_of(watcher.robot, topic)
    speaker = watcher.session.declare_publisher(key, allowed_destination=zenoh.Locality.REMOTE)  # this one is no news
    survey = Surveyor(watcher, [Meter(watcher.session, watcher.robot, topic)]).go(seconds, stopping)
    if missing := survey.instead(topic):
        return complain(missing)
    found = TopicInfo(
        row=_row(survey, topic.key),
        robot=watcher.robot,
        whole_key=key,
        qos=_QOS[topic.qos],
        matching=is_listened_to(speaker),
        fields=fields_of(topic.schema),
        parts=_parts(topic.schema),
    )
    if as_json:
        print_json(found)
    else:
        _show(found)
    return 0


def _show(found: TopicInfo) -> None:
    row = found.row
    rate = f"{shown(row.nominal_hz)} Hz" if row.nominal_hz else "on change"
    silent = "none by which to tell the rate" if row.heard else "silent"
    listeners = _names(row.subscribers)
    if not listeners:
        listeners = "somebody whose health does not tell" if found.matching else "nobody"
    page = Page()
    for name, text in (
        ("key", found.whole_key),
        ("type", row.type),
        ("rate", f"{rate} by the table; now {f'{shown(row.hz)} Hz' if row.hz is not None else silent}"),
        ("quality", found.qos),
        ("published by", _names(row.publishers, instances=True) or "nobody now"),
        ("listened to by", listeners),
    ):
        page.print(Text(f"{name:<16}{printable(text)}"))
    for title, fields in ((row.type, found.fields), *found.parts.items()):
        page.print()
        print_table((title, "", ""), ((field.name, field.type, field.doc) for field in fields))


def _row(survey: Survey, key: str) -> TopicRow:
    """Of a key, or of all that one with a `*` covers."""
    covered = [other for other in survey.keys if covers(key, other)]
    counts = [count for other in covered if other in survey.tallies for count in survey.tallies[other].counts.values()]
    rates = [rate for count in counts if (rate := count.rate) is not None]
    row = topic_of(key)
    return TopicRow(
        key=key,
        type="" if row is None else row.schema.__name__,
        nominal_hz=0.0 if row is None else row.rate_hz,
        hz=sum(rates) / len(rates) if rates else None,
        heard=sum(survey.tallies[other].samples for other in covered if other in survey.tallies),
        publishers=sorted({maker for other in covered for maker in survey.publishers(other)}),
        subscribers=survey.subscribers(key),
    )


def _names(makers: Sequence[Maker], *, instances: bool = False) -> str:
    return ", ".join(dict.fromkeys(f"{maker.name} {maker.instance}" if instances else maker.name for maker in makers))


def _parts(schema: type[msgspec.Struct]) -> dict[str, tuple[Field, ...]]:
    """The Structs within a Struct, by name."""
    found: dict[str, tuple[Field, ...]] = {}
    _, components = msgspec.json.schema_components([schema])
    for struct in msgspec.Struct.__subclasses__():
        if struct.__name__ in components and struct is not schema and not issubclass(struct, Sample):
            found[struct.__name__] = fields_of(struct)
    return found
