"""`giraff topic echo`: samples as they come."""

import math
import sys
import time
from collections.abc import Sequence
from typing import Any, Final

import msgspec

from giraff_node import robot_now_ns
from giraff_schemas.messages import Sample
from giraff_schemas.text import meant, printable
from giraff_schemas.topics import Topic
from giraff_tools.network.command import print_error, run_with_robot
from giraff_tools.network.connection import RobotConnection, Undeclared
from giraff_tools.network.robot_graph import GraphMonitor
from giraff_tools.network.topic_keys import UnknownKeyError, below_robot, find_heard_topic, is_declared
from giraff_tools.terminal.signals import StopSignal
from giraff_tools.terminal.text import json_line

_SILENT_AFTER: Final = 1.2  # s; twice the period of the slowest topic
_LOOK_EVERY: Final = 0.02  # s


class FieldError(Exception):
    """A sample has no such field. The message says which it has."""


def echo(
    key: str,
    robot: str | None,
    connect: Sequence[str],
    count: int | None,
    seconds: float | None,
    fields: Sequence[str],
    *,
    as_json: bool,
) -> int:
    """Until Ctrl-C, for `seconds` or `count` samples; the exit code."""
    try:
        key, robot = below_robot(key, robot)
        topic = find_heard_topic(key)
        for field in fields if is_declared(topic) else ():
            require_field(topic, field)
    except (UnknownKeyError, FieldError) as error:
        return print_error(str(error))
    with StopSignal() as stopping:
        return run_with_robot(
            robot, connect, lambda met: _echo(Echo(met, stopping, topic, fields, as_json=as_json), count, seconds)
        )


def _echo(it: "Echo", count: int | None, seconds: float | None) -> int:
    try:
        return it.run(math.inf if count is None else count, math.inf if seconds is None else seconds)
    except FieldError as error:
        return print_error(str(error))


def require_field(topic: Topic[Any], field: str) -> None:
    """FieldError unless samples of `topic` have a field of this name, as far as the first dot."""
    names = topic.schema.__struct_fields__
    if field.partition(".")[0] not in names:
        there = f"{meant(field, names)}it has {', '.join(names)}"
        raise FieldError(f"--field {field}: {topic.schema.__name__} has no such field; {there}")


def selected(sample: Any, fields: Sequence[str]) -> Any:
    """These of a sample, like `board.latch`; all where none is named. Raises FieldError.

    What lies below a field that is null is null.
    """
    return {field: _value(sample, field) for field in fields} if fields else sample


class Echo:
    """Prints what it hears."""

    def __init__(
        self,
        connection: RobotConnection,
        stopping: StopSignal,
        topic: Topic[Any],
        fields: Sequence[str],
        *,
        as_json: bool,
    ) -> None:
        self._connection = connection
        self._stopping = stopping
        self._topic = topic
        self._fields = fields
        self._as_json = as_json
        self._monitor = GraphMonitor(connection)
        self._complained: set[str] = set()

    def run(self, count: float, seconds: float) -> int:
        """Until so many, or so long; the exit code. Raises NoRobotError and FieldError."""
        self._connection.subscribe(self._topic)
        self._monitor.wait_for_robot(self._stopping)
        heard = self._monitor.robot_graph.heard
        began, told, doubtful = time.monotonic(), 0, True
        while not self._stopping.asked:
            self._monitor.update(now := time.monotonic())
            while heard and told < count:
                self._print_sample(*heard.popleft())
                told += 1
            self._mention()
            if told >= count or now - began >= seconds:
                break
            if doubtful and not told and now - began > _SILENT_AFTER:
                doubtful = False
                if missing := self._monitor.collect_health(self._stopping).instead(self._topic):
                    return print_error(missing)
            self._stopping.wait(min(_LOOK_EVERY, max(0.0, began + seconds - now)))
        return 0 if told or self._stopping.asked else print_error(f"nothing came on {self._topic.key} in {seconds:g} s")

    def _print_sample(self, key: str, sample: Sample | Undeclared, at_ns: int) -> None:
        given, form = (sample.content, f", {sample.form}") if isinstance(sample, Undeclared) else (sample, "")
        if self._as_json:
            content = selected(msgspec.to_builtins(given), self._fields)
            print(json_line({"key": key, "sample": content}), flush=True)
            return
        content = selected(msgspec.to_builtins(given, builtin_types=(bytes,)), self._fields)
        if self._fields:
            values = "  ".join(f"{name}: {_text(value)}" for name, value in content.items())
            print(printable(f"{key}: {values}"))
        else:
            print(f"{printable(key)}: {(robot_now_ns() - at_ns) * 1e-6:.0f} ms ago{form}")
            for name, value in content.items() if isinstance(content, dict) else [("", content)]:
                print(printable(f"  {name}{name and ': '}{_text(value)}".rstrip()))
        sys.stdout.flush()

    def _mention(self) -> None:
        """Say once what could not be read."""
        for complaint in self._connection.decode_errors:
            if complaint not in self._complained and len(self._complained) < 10:
                self._complained.add(complaint)
                print_error(printable(f"unreadable: {complaint}"))


def _value(sample: Any, field: str) -> Any:
    value = sample
    for name in field.split("."):
        if value is None:
            return None
        if not isinstance(value, dict) or name not in value:
            has = f"there are: {', '.join(map(str, value))}" if isinstance(value, dict) else "it has no parts"
            raise FieldError(f"--field {field}: there is no {name}; {has}")
        value = value[name]
    return value


def _text(value: Any) -> str:
    """For people."""
    return msgspec.json.encode(value).decode() if not isinstance(value, str) else value
