"""Reads a recording: `Recording(path)`, then its samples in the order in which they were heard.

    recording = Recording(Path("drive.mcap"))      # RecordingError: no file, no MCAP, none of this format
    recording.robot, recording.about               # name; versions, robot file (JSON), ... (about.get("tables"))
    recording.whole                                # False: cut off, by a crash or a full disk; what is there is read
    recording.seconds, recording.counts            # s; key -> samples and lost (of a whole one: as it was counted then)
    unread = Unread()                              # takes what is damaged, and what is no sample
    for sample in recording.samples(("odom", "range/*"), unread):
        sample.key, sample.heard_ns, sample.stamp_ns, sample.seq, sample.content()      # a dict
        odometry = sample.decode()                 # the Struct of the topics table; DecodeError
    unread.texts()                                 # a line for each of them; none: everything was read

Keys are those below the robot's name. A file that any other tool has written is read as long as its messages are JSON
and its topics are `giraff/<robot>/...`.
"""

import re
from base64 import b64decode
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from fnmatch import fnmatchcase
from functools import cache, cached_property, reduce
from operator import getitem
from pathlib import Path
from typing import IO, Any, Final, get_args

import msgspec
from mcap.records import Channel, Message

from giraff_core.senses import typed
from giraff_mcap.layout import DAMAGE, MAGIC, look_through, read_part, was_closed
from giraff_mcap.raw_sample import Count, LossCounter, start_of
from giraff_mcap.unread import Unread, UnreadParts
from giraff_mcap.writing import ABOUT, FORMAT_FIELD, RAW, SUMMARY, below_robot
from giraff_node.config.robot_file import put
from giraff_schemas.checks import refuse_to_read
from giraff_schemas.codec import DecodeError, decode
from giraff_schemas.format import FORMAT
from giraff_schemas.messages import Sample
from giraff_schemas.params import Param, ParamAnswer
from giraff_schemas.text import plain, printable
from giraff_schemas.topics import PARAM_DESCRIBE, ROOT, topic_of

_SHARED: Final = "robot."
_JSON: Final = "json"
_NEVER_IN_A_KEY: Final = frozenset("*$?#")
_PYTHONS_OWN: Final = re.compile(rb"\b(NaN|Infinity)\b")


class RecordingError(Exception):
    """A file that cannot be used. The message names it, the likely cause and the way out."""


@dataclass(frozen=True)
class Recorded:
    """One sample of a recording."""

    topic: str
    """The whole key."""
    key: str
    """Below the robot's name."""
    heard_ns: int
    """Wall clock of the recorder, ns since 1970; as even as its monotonic clock."""
    stamp_ns: int
    seq: int
    payload: bytes
    """As it was on the network: of keys of the topics table MessagePack."""
    encoding: str
    """Zenoh's, of the payload."""

    def content(self) -> Any:
        """Return its fields. Raises DecodeError for a payload that is no MessagePack."""
        try:
            return msgspec.msgpack.decode(self.payload)
        except (msgspec.MsgspecError, UnicodeError, RecursionError, ValueError) as error:
            raise DecodeError(f"{self.key}: {plain(error)}") from error

    def decode(self) -> Sample:
        """DecodeError: the topics table has no such key, or it is not what belongs there."""
        topic = topic_of(self.key)
        if topic is None:
            raise DecodeError(f"{self.key}: no such key in the topics table")
        sample: Sample = decode(topic, self.topic, self.payload)
        return sample


class Recording:
    """One file. Each pass reads it anew, up to the length that it had at first."""

    def __init__(self, path: Path, *, any_format: bool = False) -> None:
        """Raises RecordingError. `any_format`: its samples are passed on as they are, and nobody decodes them."""
        self.path = path
        self.whole = True
        """It was closed: nothing was cut off."""
        self.robot = ""
        self.about: dict[str, str] = {}
        self.ended_by = ""
        """Empty: not known."""
        with self._open() as file:
            if file.read(len(MAGIC)) != MAGIC:
                raise RecordingError(
                    f"{path}: not an MCAP file, or its first bytes are damaged, as a copy in text mode does; give one "
                    "that `giraff record` has written"
                )
            self.whole = was_closed(file)
            self._layout = look_through(file)
        self.about = self._layout.metadata.get(ABOUT, {})
        summary = self._layout.metadata.get(SUMMARY, {})
        self.ended_by = summary.get("ended_by", "")
        self._before = Unread()
        """What the file says is missing in it."""
        with suppress(msgspec.MsgspecError):
            self._before = msgspec.json.decode(summary.get("unread", "{}"), type=Unread)
        channels = list(self._channels())
        for channel in channels:
            if number := channel.metadata.get(FORMAT_FIELD):
                self.about.setdefault(FORMAT_FIELD, number)
        self._layout.parts.sort(key=lambda part: part.since_ns)
        unreadable = {channel.topic: why for channel in channels if (why := _why_unreadable(channel))}
        topics = {channel.topic for channel in channels if not _why_unreadable(channel)}
        robots = sorted({topic.split("/")[1] for topic in topics})
        if not robots:
            whys = "; ".join(f"{topic}: {why}" for topic, why in sorted(unreadable.items())[:3])
            damaged = "; it is damaged" if self._layout.holes else ""
            raise RecordingError(f"{path}: no recording of a Giraff: {whys or 'nothing is in it'}{damaged}")
        if len(robots) > 1:
            raise RecordingError(f"{path}: of several robots ({', '.join(robots)}), one at a time is read")
        self.robot = robots[0]
        self.keys = tuple(sorted(below_robot(topic) for topic in topics))
        """Below the robot's name; of each there may be a sample."""
        if not any_format and (why := _why_another(self.about.get(FORMAT_FIELD, ""))):
            raise RecordingError(f"{path} {why}; use the Giraff that recorded it, or record again")

    @cached_property
    def counts(self) -> dict[str, Count]:
        """By key, counted now."""
        tallies: dict[str, LossCounter] = {}
        for sample in self.samples():
            content = None
            with suppress(DecodeError):  # somebody's own
                content = sample.content()
            tallies.setdefault(sample.key, LossCounter()).add(start_of(content))
        return {key: Count(tally.count, tally.lost) for key, tally in sorted(tallies.items())}

    @cached_property
    def seconds(self) -> float:
        """s from the first sample to the last."""
        heard = [sample.heard_ns for sample in self.samples()]
        return (max(heard) - min(heard)) * 1e-9 if heard else 0.0

    @cached_property
    def bounds_ns(self) -> tuple[int, int]:
        """ns since 1970 of the first sample and, about, of the last one, without reading what is between them."""
        parts = self._layout.parts
        last = [parts[-1].since_ns]
        with suppress(*DAMAGE, MemoryError, OSError), self._open() as file:
            last += [record.log_time for record in read_part(file, parts[-1]) if isinstance(record, Message)]
        return parts[0].since_ns, max(last)

    def share_before(self, heard_ns: int) -> float:
        """Return the share of the recording, 0 to 1, that was heard before a moment (ns since 1970)."""
        begin, end = self.bounds_ns
        return min(max((heard_ns - begin) / (end - begin), 0.0), 1.0) if end > begin else 1.0

    def faults(self, unread: Unread, strange: int) -> list[str]:
        """Return a line for each thing that its reader lacks. `strange`: samples that could not be decoded."""
        lines = [f"{strange} samples could not be read, and are left out"] if strange else []
        lines += [] if self.whole else ["cut off; this is of what is there"]
        return lines + unread.texts()

    def samples(self, keys: Sequence[str] = (), unread: Unread | None = None) -> Iterator[Recorded]:
        """Those of these keys (`range/*` stands for all below it), or all; in the order in which they were heard.

        `unread` takes all that is left out. What is damaged is known when the last sample was taken.
        """
        wanted, unread = self.matching(keys), Unread() if unread is None else unread
        for channel, message in self._messages(unread):
            key = below_robot(channel.topic)
            why = _why_unreadable(channel)
            if key not in wanted and not (why and not keys):
                continue
            payload = b""
            try:
                if not why:
                    payload = _payload(key, channel, message)
            except (msgspec.MsgspecError, UnicodeError, RecursionError, ValueError, OverflowError) as error:
                named = " (NaN and Infinity are none)" if _PYTHONS_OWN.search(message.data) else ""
                why = f"no JSON that a message can hold{named}: {plain(error)}"
            if why:
                unread.leave_out(channel.topic, why)
                continue
            yield Recorded(
                topic=channel.topic,
                key=key,
                heard_ns=message.log_time,
                stamp_ns=message.publish_time,
                seq=message.sequence,
                payload=payload,
                encoding=channel.metadata.get("encoding", "application/msgpack"),
            )
        if not keys:
            for topic, left in self._before.left_out.items():
                unread.leave_out(topic, left.why, left.samples)

    def matching(self, patterns: Sequence[str]) -> set[str]:
        """The keys that any of these patterns stands for; of no pattern: all."""
        return {key for key in self.keys if not patterns or any(fnmatchcase(key, pattern) for pattern in patterns)}

    def _channels(self) -> Iterator[Channel]:
        """Find all channels. Without an index, read them from the chunks, with the time at which each chunk begins."""
        layout = self._layout
        if layout.names_all:
            yield from layout.channels.values()
            return
        found: set[int] = set()
        with self._open() as file:
            for part in layout.parts:
                with suppress(*DAMAGE, MemoryError, OSError):
                    records = list(read_part(file, part))
                    times = [record.log_time for record in records if isinstance(record, Message)]
                    part.since_ns = min(times, default=part.since_ns)
                    for channel in (record for record in records if isinstance(record, Channel)):
                        found.add(channel.id)
                        layout.channels.setdefault(channel.id, channel)
                        yield channel
        yield from (channel for channel in layout.channels.values() if channel.id not in found)

    def _messages(self, unread: Unread) -> Iterator[tuple[Channel, Message]]:
        """All that can be read, in the order in which it was heard."""
        channels = dict(self._layout.channels)
        parts = UnreadParts(self._layout)
        waiting: list[Message] = []
        with self._open() as file:
            for part in self._layout.parts:
                # Chunks may overlap: what begins later than this one waits for it.
                while waiting and waiting[-1].log_time < part.since_ns:
                    message = waiting.pop()
                    yield channels[message.channel_id], message
                try:
                    records = list(read_part(file, part))
                except (*DAMAGE, MemoryError, OSError):
                    parts.damaged(part)
                    continue
                messages = [record for record in records if isinstance(record, Message)]
                channels |= {record.id: record for record in records if isinstance(record, Channel)}
                parts.read(part, [message.log_time for message in messages])
                named = [message for message in messages if message.channel_id in channels]
                if len(named) < len(messages):
                    unread.leave_out("?", "nothing in the file names its key", len(messages) - len(named))
                waiting += reversed(named)
                waiting.sort(key=lambda message: message.log_time, reverse=True)
        while waiting:
            message = waiting.pop()
            yield channels[message.channel_id], message
        unread.gaps += [*parts.gaps(), *self._before.gaps]

    def tables(self) -> dict[str, Any]:
        """Return the tables that the services went by, as they told the recorder.

        Those of a service that told nothing are as in the robot file that the recorder had. Empty: it had none.
        Sensors are as in `RobotConfig`.
        """
        try:
            tables = msgspec.json.decode(self.about.get("tables", "{}"), type=dict[str, Any])
            if "robot" in tables:
                tables["robot"] = typed(tables["robot"])
            for service, params in self.described.items():
                put_params(tables, service, params)
        except (msgspec.MsgspecError, TypeError, ValueError) as error:
            raise RecordingError(f"{self.path}: the robot file in it is damaged: {plain(error)}") from error
        return tables

    @cached_property
    def described(self) -> dict[str, tuple[Param, ...]]:
        """Parameters of each service when the recorder asked it first."""
        found: dict[str, tuple[Param, ...]] = {}
        for answer in map(
            params_in, self.samples((PARAM_DESCRIBE.key,)) if self.matching((PARAM_DESCRIBE.key,)) else ()
        ):
            if answer is not None and is_whole(answer):
                found.setdefault(answer.service, answer.params)
        return found

    def _open(self) -> IO[bytes]:
        if why := refuse_to_read(self.path):
            raise RecordingError(why)
        try:
            return self.path.open("rb")
        except OSError as error:
            raise RecordingError(f"{self.path}: {error.strerror}") from error


def params_in(sample: Recorded) -> ParamAnswer | None:
    """Return what a service has told of its parameters; None: this is something else."""
    if not fnmatchcase(sample.key, PARAM_DESCRIBE.key):
        return None
    try:
        answer = msgspec.msgpack.decode(sample.payload, type=ParamAnswer)
    except msgspec.MsgspecError:  # torn, or played from a file of another format
        return None
    return answer if sample.key == PARAM_DESCRIBE.key.replace("*", answer.service) else None


def is_whole(answer: ParamAnswer) -> bool:
    """Tell whether an answer has all parameters of its service, and not the one alone that was set."""
    return any(param.name.startswith(_SHARED) for param in answer.params)


def put_params(tables: dict[str, Any], service: str, params: Iterable[Param]) -> None:
    """Set the values of parameters in the table of their service, and those of [robot] there."""
    for param in params:
        path = param.name if param.name.startswith(_SHARED) else f"{service}.{param.name}"
        put(tables, tuple(path.split(".")), param.value)


def _why_another(number: str) -> str:
    """Say why samples of a format are not decoded; empty: they are of this one."""
    if not number:
        return f"has no format number, and this Giraff reads {FORMAT}"
    if number != str(FORMAT):
        return f"was recorded by a Giraff of format {printable(number)}, and this one reads {FORMAT}"
    return ""


def _why_unreadable(channel: Channel) -> str:
    """Say why nothing of a channel can be read; empty: it can."""
    return _why_not(channel.topic, channel.message_encoding)


@cache
def _why_not(topic: str, encoding: str) -> str:
    root, *chunks = topic.split("/")
    if root != ROOT or len(chunks) < 2:
        return f"its topic is not {ROOT}/ROBOT/KEY"
    if not all(chunks) or _NEVER_IN_A_KEY & set(topic):
        return "its topic is no key of Zenoh"
    if encoding not in {_JSON, RAW}:
        return f"its messages are {encoding or 'of no encoding'}, and only JSON is read"
    return ""


def _payload(key: str, channel: Channel, message: Message) -> bytes:
    """Return a payload as it was on the network. Raises what msgspec raises."""
    if channel.message_encoding == RAW:
        return message.data
    content = msgspec.json.decode(message.data)
    for *parts, field in _bytes_of(key):
        with suppress(KeyError, TypeError, ValueError):  # torn, or of another format: `decode` tells
            within = reduce(getitem, parts, content)
            within[field] = b64decode(within[field], validate=True)
    return msgspec.msgpack.encode(content)


@cache
def _bytes_of(key: str) -> tuple[tuple[str, ...], ...]:
    """Return the names that lead to each field of bytes."""
    topic = topic_of(key)
    return () if topic is None else tuple(_bytes_in(topic.schema))


def _bytes_in(struct: type[msgspec.Struct]) -> Iterator[tuple[str, ...]]:
    for field in msgspec.structs.fields(struct):
        for type_ in get_args(field.type) or (field.type,):
            if type_ is bytes:
                yield (field.name,)
            elif isinstance(type_, type) and issubclass(type_, msgspec.Struct):
                yield from ((field.name, *names) for names in _bytes_in(type_))
