"""Reads a recording: `Recording(path)`, then its samples in the order in which they were heard.

    recording = Recording(Path("drive.mcap"))      # RecordingError: no file, no MCAP, none of ours
    recording.robot, recording.about               # name; versions, robot file (JSON), ... (about.get("tables"))
    recording.whole                                # False: cut off, by a crash or a full disk; what is there is read
    recording.seconds, recording.counts            # s; key -> samples and lost (of a whole one: as it was counted then)
    for sample in recording.samples(keys=("odom", "range/*")):
        sample.key, sample.heard_ns, sample.stamp_ns, sample.seq, sample.content()      # a dict
        odometry = sample.decode()                 # the Struct of the topics table; DecodeError

Keys are those below the robot's name. A file that any other tool has written is read as long as its messages are JSON
and its topics are `giraff/<robot>/...`.
"""

from __future__ import annotations

import struct
from base64 import b64decode
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from fnmatch import fnmatchcase
from functools import cache, cached_property
from pathlib import Path
from typing import IO, Any, Final

import msgspec
from mcap.exceptions import McapError
from mcap.reader import SeekingReader
from mcap.records import Channel, Header, Message, Metadata
from mcap.stream_reader import CRCValidationError, StreamReader
from zstandard import ZstdError

from giraff_core.robot import RobotConfig
from giraff_core.sensors import by_type
from giraff_mcap.raw_sample import Count, LossCounter, start_of
from giraff_mcap.writing import ABOUT, SUMMARY, below_robot
from giraff_node.config.moved import modern, put
from giraff_schemas.codec import DecodeError, decode
from giraff_schemas.messages import Sample
from giraff_schemas.params import Param, ParamAnswer
from giraff_schemas.text import plain
from giraff_schemas.topics import PARAM_DESCRIBE, ROOT, topic_of

_SHARED: Final = "robot."
_MAGIC: Final = b"\x89MCAP0\r\n"
_LARGEST: Final = 1 << 28
"""Bytes of a record: a damaged length must not fill the memory."""
_DAMAGE: Final = (McapError, CRCValidationError, ZstdError, struct.error, RuntimeError, ValueError, EOFError, KeyError)


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
    data: bytes
    """JSON."""
    encoding: str
    """Zenoh's, of the payload."""

    def content(self) -> Any:
        """Return its fields. Bytes, which JSON has as base64, are bytes again."""
        content = msgspec.json.decode(self.data)
        for field in _fields_of_bytes(self.key):
            with suppress(KeyError, TypeError, ValueError):  # of another version: `decode` tells
                content[field] = b64decode(content[field], validate=True)
        return content

    def payload(self) -> bytes:
        """As it was on the network: MessagePack. Raises RecordingError for what never was there."""
        try:
            return msgspec.msgpack.encode(self.content())
        except (ValueError, OverflowError, RecursionError) as error:
            raise RecordingError(f"a sample of {self.topic} is damaged: {plain(error)}") from error

    def decode(self) -> Sample:
        """DecodeError: the topics table has no such key, or it is not what belongs there."""
        topic = topic_of(self.key)
        if topic is None:
            raise DecodeError(f"{self.key}: no such key in the topics table")
        try:
            sample: Sample = decode(topic, self.topic, self.payload())
        except RecordingError as error:
            raise DecodeError(str(error)) from error
        return sample


class Recording:
    """One file, read anew with each look."""

    def __init__(self, path: Path) -> None:
        """Raises RecordingError."""
        self.path = path
        self.whole = True
        """It was closed: nothing was cut off."""
        self.robot = ""
        self.about: dict[str, str] = {}
        self.ended_by = ""
        """Empty: not known."""
        with self._open() as file:
            if file.read(len(_MAGIC)) != _MAGIC:
                raise RecordingError(f"{path}: not an MCAP file; give one that `giraff record` has written")
            self.whole = _is_whole(file)
        topics = self._look()
        robots = sorted({topic.split("/")[1] for topic in topics if topic.startswith(f"{ROOT}/") and "/" in topic[7:]})
        if not robots:
            named = f"its topics are {', '.join(sorted(topics)[:5])}" if topics else "nothing is in it"
            raise RecordingError(f"{path}: no recording of a Giraff: {named}")
        if len(robots) > 1:
            raise RecordingError(f"{path}: of several robots ({', '.join(robots)}), one at a time is read")
        self.robot = robots[0]
        self.keys = tuple(sorted(below_robot(topic) for topic in topics))
        """Below the robot's name; of each there may be a sample."""

    @cached_property
    def counts(self) -> dict[str, Count]:
        """By key, counted now."""
        tallies: dict[str, LossCounter] = {}
        for sample in self.samples():
            tallies.setdefault(sample.key, LossCounter()).add(start_of(sample.content()))
        return {key: Count(tally.count, tally.lost) for key, tally in sorted(tallies.items())}

    @cached_property
    def seconds(self) -> float:
        """s from the first sample to the last."""
        heard = [sample.heard_ns for sample in self.samples()]
        return (max(heard) - min(heard)) * 1e-9 if heard else 0.0

    def samples(self, keys: Sequence[str] = ()) -> Iterator[Recorded]:
        """Those of these keys (`range/*` stands for all below it), or all; in the order in which they were heard."""
        wanted = self.matching(keys)
        for channel, message in self._messages():
            key = below_robot(channel.topic)
            if key not in wanted:
                continue
            yield Recorded(
                topic=channel.topic,
                key=key,
                heard_ns=message.log_time,
                stamp_ns=message.publish_time,
                seq=message.sequence,
                data=message.data,
                encoding=channel.metadata.get("encoding", "application/msgpack"),
            )

    def matching(self, patterns: Sequence[str]) -> set[str]:
        """The keys that any of these patterns stands for; of no pattern: all."""
        return {key for key in self.keys if not patterns or any(fnmatchcase(key, pattern) for pattern in patterns)}

    def _messages(self) -> Iterator[tuple[Channel, Message]]:
        with self._open() as file:
            try:
                if self.whole:
                    for _, channel, message in SeekingReader(
                        file, validate_crcs=True, record_size_limit=_LARGEST
                    ).iter_messages():
                        yield channel, message
                    return
                channels: dict[int, Channel] = {}
                for record in _records(file):
                    if isinstance(record, Channel):
                        channels[record.id] = record
                    elif isinstance(record, Message) and record.channel_id in channels:
                        yield channels[record.channel_id], record
            except _DAMAGE as error:
                raise RecordingError(
                    f"{self.path}: damaged inside ({_what(error)}); `giraff record --repair` saves "
                    "what comes before the damage"
                ) from error

    def _look(self) -> set[str]:
        """Take in header and metadata; all topics."""
        topics: set[str] = set()
        metadata: dict[str, dict[str, str]] = {}
        with self._open() as file:
            try:
                if self.whole:
                    reader = SeekingReader(file, validate_crcs=True, record_size_limit=_LARGEST)
                    metadata = {record.name: record.metadata for record in reader.iter_metadata()}
                    summary = reader.get_summary()
                    channels = list(summary.channels.values()) if summary else []
                else:
                    channels = []
                    for record in _records(file):
                        if isinstance(record, Channel):
                            channels.append(record)
                        elif isinstance(record, Metadata):
                            metadata[record.name] = record.metadata
            except _DAMAGE as error:
                raise RecordingError(f"{self.path}: damaged ({_what(error)})") from error
        for channel in channels:
            if channel.message_encoding != "json":
                raise RecordingError(
                    f"{self.path}: {channel.topic} is encoded as {channel.message_encoding!r}, and only JSON is read"
                )
            topics.add(channel.topic)
        self.about = metadata.get(ABOUT, {})
        self.ended_by = metadata.get(SUMMARY, {}).get("ended_by", "")
        return topics

    def tables(self) -> dict[str, Any]:
        """Return the tables that the services went by, as they told the recorder.

        Those of a service that told nothing are as in the robot file that the recorder had. Empty: it had none.
        Each field stands where it stands now, and sensors as in `RobotConfig`.
        """
        try:
            tables = modern(msgspec.json.decode(self.about.get("tables", "{}"), type=dict[str, Any])).tables
            if "robot" in tables:
                tables["robot"] = by_type(tables["robot"])
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
        try:
            return self.path.open("rb")
        except OSError as error:
            raise RecordingError(f"{self.path}: {error.strerror}") from error


def params_in(sample: Recorded) -> ParamAnswer | None:
    """Return what a service has told of its parameters; None: this is something else."""
    if not fnmatchcase(sample.key, PARAM_DESCRIBE.key):
        return None
    try:
        answer = msgspec.json.decode(sample.data, type=ParamAnswer)
    except msgspec.MsgspecError:  # of another version
        return None
    return answer if sample.key == PARAM_DESCRIBE.key.replace("*", answer.service) else None


def is_whole(answer: ParamAnswer) -> bool:
    """Tell whether an answer has all parameters of its service, and not the one alone that was set."""
    return any(param.name.startswith(_SHARED) for param in answer.params)


def put_params(tables: dict[str, Any], service: str, params: Iterable[Param]) -> None:
    """Set the values of parameters in the table of their service, and those of [robot] there."""
    for param in params:
        if not param.name.startswith(_SHARED):
            put(tables, (service, *param.name.split(".")), param.value)
        elif (field := param.name.removeprefix(_SHARED)) in RobotConfig.__struct_fields__:
            put(tables, ("robot", field), param.value)


def _what(error: Exception) -> str:
    return str(error) or type(error).__name__


def _is_whole(file: IO[bytes]) -> bool:
    file.seek(0, 2)
    if file.tell() < 2 * len(_MAGIC):
        return False
    file.seek(-len(_MAGIC), 2)
    return file.read() == _MAGIC


def _records(file: IO[bytes]) -> Iterator[Any]:
    """Of a file that was cut off: all up to the cut, or to what is damaged before it."""
    file.seek(0)
    records = StreamReader(file, record_size_limit=_LARGEST, validate_crcs=True).records
    while True:
        try:
            record = next(records, None)
        except _DAMAGE:
            return
        if record is None:
            return
        if not isinstance(record, Header):
            yield record


@cache
def _fields_of_bytes(key: str) -> tuple[str, ...]:
    topic = topic_of(key)
    fields = () if topic is None else msgspec.structs.fields(topic.schema)
    return tuple(field.name for field in fields if field.type is bytes)
