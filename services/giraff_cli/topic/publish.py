"""`giraff topic pub`: say something in the name of a robot, which must not be there for what is its own to say."""

from __future__ import annotations

import secrets
import time
from collections.abc import Mapping, Sequence
from typing import Any, Final

import msgspec
import zenoh

from giraff_cli.network.command import print_error, run_on_network
from giraff_cli.network.connection import RobotConnection
from giraff_cli.network.robot_graph import GraphMonitor, is_listened_to
from giraff_cli.network.topic_keys import UnknownKeyError, find_topic, publish_refusal
from giraff_cli.terminal.page import print_json
from giraff_cli.terminal.signals import StopSignal
from giraff_schemas.checks import converted
from giraff_schemas.codec import encode, encoding_of, stamped
from giraff_schemas.messages import Sample
from giraff_schemas.text import plain
from giraff_schemas.topics import Topic, key_of

_LOOK_FOR: Final = 1.5  # s, for a robot of this name: a service that is met late is one that is there
FILLED_IN: Final = Sample.__struct_fields__
_REFUSED_LATER: Final = 1


class NotASampleError(Exception):
    """What somebody typed is no sample of a topic. The message says why."""


class Published(msgspec.Struct, kw_only=True):
    """What came of it."""

    robot: str
    key: str
    instance: str
    sent: int = 0
    matching: bool = False
    """Somebody listened when the last one was sent."""


def pub(
    key: str,
    text: str,
    robot: str | None,
    connect: Sequence[str],
    rate: float | None,
    count: int | None,
    *,
    as_json: bool,
) -> int:
    """Once, or at `rate` until Ctrl-C or `count`; the exit code."""
    try:
        topic = find_topic(key)
        if "*" in topic.key:
            return print_error(f"{key}: a sample goes to one key; name what `*` stands for")
        sample = parse_sample(topic, text)
    except (UnknownKeyError, NotASampleError) as error:
        return print_error(str(error))

    def act(connection: RobotConnection) -> int:
        if not connection.robot:
            return print_error("--robot NAME is missing: in whose name is this said?")
        return _publish(connection, stopping, topic, sample, 0.0 if rate is None else 1.0 / rate, count or 0, as_json)

    with StopSignal() as stopping:
        return run_on_network(robot, connect, act)


def parse_sample(topic: Topic[Any], text: str) -> Sample:
    """What somebody typed as JSON. Raises NotASampleError."""
    name = topic.schema.__name__
    try:
        given = msgspec.json.decode(text)
        if not isinstance(given, dict):
            raise NotASampleError(f"a {name} is a JSON object, like {{{_example(topic)}}}")
        if taken := [field for field in FILLED_IN if field in given]:
            raise NotASampleError(f"{', '.join(taken)}: filled in when it is published; leave it out")
        if topic.names:
            given.setdefault(topic.names, topic.name_in(topic.key))
    except (ValueError, RecursionError) as error:
        raise NotASampleError(f"not JSON: {plain(error)}; quote it, like '{{{_example(topic)}}}'") from error
    try:
        sample: Sample = converted(given, topic.schema)
    except ValueError as error:
        raise NotASampleError(f"not a {name}: {error}; it has {_example(topic)}") from error
    if topic.names and getattr(sample, topic.names) != topic.name_in(topic.key):
        raise NotASampleError(f"{topic.names} is {getattr(sample, topic.names)!r}, and the key says otherwise")
    if unknown := _unknown(given, msgspec.to_builtins(sample)):
        raise NotASampleError(f"a {name} has no {', '.join(unknown)}; it has {_example(topic)}")
    return sample


def _publish(
    connection: RobotConnection,
    stopping: StopSignal,
    topic: Topic[Any],
    sample: Sample,
    period: float,
    count: int,
    as_json: bool,
) -> int:
    monitor = GraphMonitor(connection)
    monitor.wait(_LOOK_FOR, stopping)
    if why := publish_refusal(topic, monitor.robot_graph.spoken):
        return print_error(why)
    result = Published(robot=connection.robot, key=topic.key, instance=secrets.token_hex(8))
    publisher = connection.session.declare_publisher(
        key_of(connection.robot, topic),
        encoding=encoding_of(topic.schema),
        congestion_control=zenoh.CongestionControl.DROP,
        priority=zenoh.Priority.DATA_HIGH,
        express=True,
        allowed_destination=zenoh.Locality.REMOTE,
    )
    due = time.monotonic()
    trouble = ""
    while True:
        monitor.look(time.monotonic())
        if trouble := publish_refusal(topic, monitor.robot_graph.spoken):
            break
        result.matching = is_listened_to(publisher)
        publisher.put(encode(stamped(sample, result.sent, time.time_ns(), result.instance)))
        result.sent += 1
        due += period
        if not period or (count and result.sent >= count) or stopping.wait(max(0.0, due - time.monotonic())):
            break
    _tell(result, as_json=as_json)
    if trouble:
        print_error(trouble)
        return _REFUSED_LATER
    return 0


def _tell(result: Published, *, as_json: bool) -> None:
    if as_json:
        print_json(result)
        return
    heard = "" if result.matching else "; nobody listens there"
    print(f"{result.robot}: {result.sent} on {result.key}, instance {result.instance}{heard}")


def _unknown(given: Any, taken: Any, path: str = "") -> list[str]:
    """Names in `given` of which nothing is left in `taken`."""
    if isinstance(given, Mapping) and isinstance(taken, Mapping):
        missing = [path + name for name in given if name not in taken]
        return missing + [
            name
            for field, value in given.items()
            if field in taken
            for name in _unknown(value, taken[field], f"{path}{field}.")
        ]
    return []


def _example(topic: Topic[Any]) -> str:
    names = (name for name in topic.schema.__struct_fields__ if name not in FILLED_IN)
    return ", ".join(f'"{name}": …' for name in names)
