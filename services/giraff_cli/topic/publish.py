"""`giraff topic pub`: say something in the name of a robot, which must not be there for what is its own to say."""

import math
import secrets
import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final

import msgspec
import zenoh

from giraff_schemas.checks import converted, require_sendable
from giraff_schemas.codec import encode, encoding_of, stamped
from giraff_schemas.messages import Sample
from giraff_schemas.text import meant, plain
from giraff_schemas.topics import TOPICS, Topic, key_of
from giraff_tools.network.command import print_error, run_on_network
from giraff_tools.network.connection import RobotConnection
from giraff_tools.network.robot_graph import GraphMonitor, is_listened_to
from giraff_tools.network.topic_keys import (
    UnknownKeyError,
    below_robot,
    find_published_topic,
    is_declared,
    publish_refusal,
)
from giraff_tools.terminal.page import print_json
from giraff_tools.terminal.signals import StopSignal

_LOOK_FOR: Final = 1.5  # s, for a robot of this name: a service that is met late is one that is there
FILLED_IN: Final = Sample.__struct_fields__
_REFUSED_LATER: Final = 1
_LONGEST_SHOWN: Final = 40  # characters of a number
_MISTYPED: Final = 0.75
"""Share of letters that a key has in common with one of the table that was meant."""


class NotASampleError(Exception):
    """What somebody typed is no sample of a topic. The message says why."""


class Published(msgspec.Struct, kw_only=True):
    """What came of it."""

    robot: str
    key: str
    instance: str
    """Empty: the key is a maker's own, whose samples name none."""
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
        key, robot = below_robot(key, robot)
        topic = find_published_topic(key)
        message = parse_sample(topic, text) if is_declared(topic) else read_json(text)
    except (UnknownKeyError, NotASampleError) as error:
        return print_error(str(error))

    def act(connection: RobotConnection) -> int:
        if not connection.robot:
            return print_error("--robot NAME is missing: in whose name is this said?")
        return _publish(connection, stopping, topic, message, 0.0 if rate is None else 1.0 / rate, count or 0, as_json)

    with StopSignal() as stopping:
        return run_on_network(robot, connect, act)


def read_json(text: str) -> Any:
    """Return what somebody typed for a maker's key. Raises NotASampleError."""
    value = _decoded(text, '"angle": 1.5')
    _require_sendable(value)
    return value


def _require_sendable(value: Any, path: str = "") -> None:
    """Raise NotASampleError, with the name of the field, where a number fits into no message."""
    if isinstance(value, dict):
        for name, inner in value.items():
            _require_sendable(inner, f"{path}.{name}" if path else name)
        return
    try:
        require_sendable(value)
    except (ValueError, RecursionError) as error:
        raise NotASampleError(f"{path}: {plain(error)}" if path else plain(error)) from error


def parse_sample(topic: Topic[Any], text: str) -> Sample:
    """What somebody typed as JSON. Raises NotASampleError."""
    name = topic.schema.__name__
    given = _decoded(text, _example(topic))
    if not isinstance(given, dict):
        raise NotASampleError(f"a {name} is a JSON object, like {{{_example(topic)}}}")
    if taken := [field for field in FILLED_IN if field in given]:
        raise NotASampleError(f"{', '.join(taken)}: filled in when it is published; leave it out")
    if topic.names:
        given.setdefault(topic.names, topic.name_in(topic.key))
    try:
        sample: Sample = converted(given, topic.schema)
    except ValueError as error:
        raise NotASampleError(f"not a {name}: {error}; it has {_example(topic)}") from error
    if topic.names and getattr(sample, topic.names) != topic.name_in(topic.key):
        raise NotASampleError(f"{topic.names} is {getattr(sample, topic.names)!r}, and the key says otherwise")
    if unknown := _unknown(given, msgspec.to_builtins(sample)):
        raise NotASampleError(f"a {name} has no {', '.join(unknown)}; it has {_example(topic)}")
    return sample


def _decoded(text: str, example: str) -> Any:
    """Return the value of JSON text. Raises NotASampleError, which shows the `example` where it is no JSON."""
    try:
        return msgspec.json.Decoder(float_hook=_float).decode(text)
    except msgspec.ValidationError as error:  # of `_float` alone: no type is asked for
        raise NotASampleError(plain(error)) from error
    except (ValueError, RecursionError) as error:
        raise NotASampleError(f"not JSON: {plain(error)}; quote it, like '{{{example}}}'") from error


def _float(text: str) -> float:
    if math.isinf(number := float(text)):
        raise ValueError(f"{text[:_LONGEST_SHOWN]} is beyond 64 bits: no message can hold it")
    return number


def _publish(
    connection: RobotConnection,
    stopping: StopSignal,
    topic: Topic[Any],
    message: Any,
    period: float,
    count: int,
    as_json: bool,
) -> int:
    # Before the look around: who listens is known a moment later.
    publisher = connection.session.declare_publisher(
        key_of(connection.robot, topic),
        congestion_control=zenoh.CongestionControl.DROP,
        priority=zenoh.Priority.DATA_HIGH,
        express=True,
        allowed_destination=zenoh.Locality.REMOTE,
    )
    monitor = GraphMonitor(connection)
    if not is_declared(topic):
        connection.subscribe(topic)
    monitor.wait(_LOOK_FOR, stopping)
    if why := publish_refusal(topic, monitor.robot_graph.spoken):
        return print_error(why)
    result = Published(
        robot=connection.robot, key=topic.key, instance=secrets.token_hex(8) if is_declared(topic) else ""
    )
    encoding, payload = _encoded(topic, message, result, [sample for _, sample, _ in monitor.robot_graph.heard])
    is_new = not (is_declared(topic) or monitor.robot_graph.heard or is_listened_to(publisher))
    if is_new and (hint := meant(topic.key, (row.key for row in TOPICS), _MISTYPED)):
        return print_error(f"nobody publishes {topic.key} and nobody listens to it; {hint.rstrip()}")
    due = time.monotonic()
    trouble = ""
    while True:
        monitor.update(time.monotonic())
        if trouble := publish_refusal(topic, monitor.robot_graph.spoken):
            break
        result.matching = is_listened_to(publisher)
        publisher.put(payload(), encoding=encoding)
        result.sent += 1
        due += period
        if not period or (count and result.sent >= count) or stopping.wait(max(0.0, due - time.monotonic())):
            break
    _print_result(result, as_json=as_json)
    if trouble:
        print_error(trouble)
        return _REFUSED_LATER
    return 0


def _encoded(
    topic: Topic[Any], message: Any, result: Published, heard: Sequence[Any]
) -> tuple[str, Callable[[], bytes]]:
    """The encoding, and what makes the next payload."""
    if is_declared(topic):
        return encoding_of(topic.schema), lambda: encode(stamped(message, result.sent, time.time_ns(), result.instance))
    if heard and heard[-1].form == "JSON":
        return "application/json", lambda: msgspec.json.encode(message)
    return "application/msgpack", lambda: msgspec.msgpack.encode(message)


def _print_result(result: Published, *, as_json: bool) -> None:
    if as_json:
        print_json(result)
        return
    heard = "" if result.matching else "; nobody listens there"
    who = f", instance {result.instance}" if result.instance else ""
    print(f"{result.robot}: {result.sent} on {result.key}{who}{heard}")


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
