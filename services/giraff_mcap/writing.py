"""Writes a recording: one channel a key, with when each message was heard and when it was made.

Messages of the topics table are JSON, with their schema. Others are kept as they came, byte for byte.

A chunk is closed and on disk with each `sync`: what ends this process or the machine costs what came after the last.
"""

import contextlib
import io
import os
import time
from collections.abc import Iterable, Mapping
from fnmatch import fnmatchcase
from operator import attrgetter
from pathlib import Path
from types import TracebackType
from typing import IO, Any, Final, NamedTuple, Self, cast

import msgspec
from mcap.data_stream import RecordBuilder
from mcap.records import Channel, Schema
from mcap.writer import CompressionType, Writer

from giraff_mcap.raw_sample import Count, LossCounter, RawSample, start_of
from giraff_mcap.unread import Unread
from giraff_schemas.params import ParamAnswer
from giraff_schemas.text import plain
from giraff_schemas.topics import PARAM_DESCRIBE, ROOT, topic_of

ENCODING: Final = "jsonschema"


class DurableFile(io.BufferedIOBase):
    """A file that is on disk up to its last `sync`, whatever happens to process, disk and power.

    It takes what is written into memory; `sync` puts all of it on disk, or leaves the file as it was.
    """

    def __init__(self, path: Path) -> None:
        """Makes the file. Raises OSError, FileExistsError where it is there already: nothing is written over."""
        super().__init__()
        self._pending = bytearray()
        self._synced = 0
        self._file = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o644)
        folder = os.open(path.resolve().parent, os.O_RDONLY | os.O_DIRECTORY)
        try:
            os.fsync(folder)  # the name is only then on disk, too
        finally:
            os.close(folder)

    def write(self, data: Any, /) -> int:
        """Raises nothing: only `sync` touches the disk."""
        before = len(self._pending)
        self._pending += data
        return len(self._pending) - before

    def tell(self) -> int:
        return self._synced + len(self._pending)

    def sync(self) -> None:
        """Raises OSError; then the file ends where it did before, between two records."""
        try:
            pending = bytes(self._pending)
            while pending:
                pending = pending[os.write(self._file, pending) :]
            os.fdatasync(self._file)
        except OSError:
            self._pending.clear()
            with contextlib.suppress(OSError):
                os.ftruncate(self._file, self._synced)
                os.lseek(self._file, self._synced, os.SEEK_SET)
            raise
        self._synced, self._pending = self.tell(), bytearray()

    def close(self) -> None:
        """Lets go of it; what was not synced is not in it."""
        if not self.closed:
            os.close(self._file)
        super().close()


def name_of(type_: type[msgspec.Struct]) -> str:
    """As in the encoding that travels with each sample."""
    return f"giraff.{type_.__name__}"


def schema_of(type_: type[msgspec.Struct]) -> bytes:
    """Return the JSON Schema of a message, in the plain form that Foxglove takes.

    Its parser wants a `type` at each field: it knows neither `$ref` nor `anyOf`, an `enum` only beside a type, and an
    array by one type of its items, which is no array. So what is referred to stands where it is used, and a field that
    may be null has the type that it has when it is not. A field that is an array of arrays is left out: with it,
    Foxglove would refuse the whole key. The data have it all the same.
    """
    _, components = msgspec.json.schema_components([type_])
    return msgspec.json.encode(_plain(components[type_.__name__], components))


def _plain(schema: dict[str, Any], components: dict[str, Any]) -> dict[str, Any]:
    if "$ref" in schema:
        return _plain(components[schema["$ref"].rpartition("/")[2]], components)
    if "anyOf" in schema:
        (only,) = (choice for choice in schema["anyOf"] if choice != {"type": "null"})
        return _plain(only, components)
    plain = {name: value for name, value in schema.items() if name not in {"prefixItems", "items", "required"}}
    if "enum" in schema:
        return {"type": "string", **plain}
    if "prefixItems" in schema or schema.get("type") == "array":
        return {**plain, "items": _plain((schema.get("prefixItems") or [schema["items"]])[0], components)}
    if schema.get("type") == "object":
        fields = {name: _plain(field, components) for name, field in schema.get("properties", {}).items()}
        flat = {k: field for k, field in fields.items() if field.get("items", {}).get("type") != "array"}
        return {**plain, "properties": flat}
    return plain


PROFILE: Final = "giraff"
RAW: Final = "zenoh"
"""Message encoding of channels that hold payloads as they came. The channel's metadata name Zenoh's encoding."""
ABOUT: Final = "giraff"
"""Name of the metadata that tells of robot and recorder; written at once."""
SUMMARY: Final = "giraff.summary"
"""Name of the metadata that tells how it ended, and what was lost; only in a file that was closed."""
FORMAT_FIELD: Final = "format"
"""Field of `ABOUT`, and of the metadata of each channel: the beginning of a file may be damaged."""

_MOST_CHANNELS: Final = 10_000
"""Number of keys in a file. MCAP counts them with 16 bits, and anybody may invent some."""
_INDEX_OF_A_CHUNK: Final = 100  # bytes of the summary, and a few for each channel
_INDEX_OF_A_KEY: Final = 10
_SUMMARY: Final = 20_000  # bytes that end a file, besides: schemas, channels, counts


class _Channel(NamedTuple):
    id: int
    tally: LossCounter
    is_raw: bool


class RecordingWriter:
    """One file. Its `add` touches no disk; the others raise OSError, and then the file holds what it held before."""

    def __init__(self, path: Path, about: Mapping[str, str], to_wall_ns: int | None = None) -> None:
        """Makes the file, which must not be there yet.

        `about`: what whoever reads it should know. `to_wall_ns`: what makes a wall clock's time of `RawSample.at_ns`;
        None: what does so now.
        """
        self.path = path
        self.counts: dict[str, LossCounter] = {}
        """By key below the robot's name."""
        self.unread = Unread()
        """What is not in the file: payloads that have no JSON, and what a repair could not read."""
        self._file = DurableFile(path)
        self._writer = Writer(cast(IO[bytes], self._file), compression=CompressionType.ZSTD, chunk_size=1 << 22)
        self._format = {field: number for field, number in about.items() if field == FORMAT_FIELD}
        self._schemas: dict[str, int] = {}
        self._channels: dict[tuple[str, str], _Channel] = {}
        """By key and Zenoh's encoding."""
        self._copies = RecordBuilder()
        """Channels that the next `sync` names outside of their chunk, too: that may be damaged."""
        self._chunks = self._largest = 0
        # The wall clock as of the beginning, gone on by the monotonic one: it stays even when somebody sets the clock.
        self._to_wall_ns = time.time_ns() - time.monotonic_ns() if to_wall_ns is None else to_wall_ns
        self.first_ns: int | None = None
        """When the first sample was heard, wall clock."""
        self.last_ns: int | None = None
        self._writer.start(PROFILE, f"giraff {about.get('version', '')}".strip())
        self._writer.add_metadata(ABOUT, dict(about))
        self._file.sync()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._file.close()

    @property
    def size(self) -> int:
        """Bytes it would have if it were closed now, and never less."""
        chunk = _INDEX_OF_A_CHUNK + _INDEX_OF_A_KEY * len(self._channels)
        return self._file.tell() + self._largest + (self._chunks + 1) * chunk + _SUMMARY

    @property
    def seconds(self) -> float:
        """s from the first sample to the last."""
        return 0.0 if self.first_ns is None or self.last_ns is None else (self.last_ns - self.first_ns) * 1e-9

    def add(self, samples: Iterable[RawSample]) -> None:
        """Take samples, in any order of keys."""
        for sample in sorted(samples, key=attrgetter("at_ns")):
            self._add(sample)

    def sync(self) -> None:
        """Put all that was taken on disk."""
        before = self._file.tell()
        self._writer.flush()
        self._chunks += 1
        self._largest = max(self._largest, self._file.tell() - before)
        self._file.write(self._copies.end())
        self._file.sync()

    def close(self, ended_by: str) -> None:
        """End the file with its index, what was counted, and what is missing."""
        summary = {"ended_by": ended_by, "counts": msgspec.json.encode(self.totals).decode()}
        if self.unread:
            summary["unread"] = msgspec.json.encode(self.unread).decode()
        self._writer.flush()
        self._writer.add_metadata(SUMMARY, summary)
        self._writer.finish()
        self._file.sync()
        self._file.close()

    @property
    def totals(self) -> dict[str, Count]:
        """By key."""
        return {key: Count(tally.count, tally.lost) for key, tally in sorted(self.counts.items())}

    def _add(self, sample: RawSample) -> None:
        known = self._channels.get((sample.key, sample.encoding))
        if known is None and len(self._channels) >= _MOST_CHANNELS:
            self.unread.leave_out("?", f"the file has {_MOST_CHANNELS} keys")
            return
        channel, tally, is_raw = known or self._channel(sample)
        content: Any = None
        data = sample.payload
        try:
            content = msgspec.msgpack.decode(sample.payload)
            if not is_raw:
                data = msgspec.json.encode(content)
        except (msgspec.MsgspecError, UnicodeError, RecursionError, TypeError, ValueError, OverflowError) as error:
            if not is_raw:
                why = f"not MessagePack that has a JSON ({len(sample.payload)} bytes): {plain(error)}"
                self.unread.leave_out(sample.key, why)
                return
        start = start_of(content)
        at_ns = sample.at_ns + self._to_wall_ns
        if self.first_ns is None:
            self.first_ns = at_ns
        self.last_ns = at_ns
        tally.add(start)
        self._writer.add_message(
            channel,
            log_time=at_ns,
            data=data,
            publish_time=start.stamp_ns if start else at_ns,
            sequence=start.seq & 0xFFFFFFFF if start else 0,
        )

    def _channel(self, sample: RawSample) -> _Channel:
        below = below_robot(sample.key)
        topic = topic_of(below)
        type_: type[msgspec.Struct] | None = None if topic is None else topic.schema
        if fnmatchcase(below, PARAM_DESCRIBE.key):
            type_ = ParamAnswer
        encoding, schema_id = RAW if type_ is None else "json", 0
        metadata = {"encoding": sample.encoding, **self._format}
        if type_ is not None:
            name, schema = name_of(type_), schema_of(type_)
            if name not in self._schemas:
                self._schemas[name] = self._writer.register_schema(name, ENCODING, schema)
            schema_id = self._schemas[name]
            Schema(id=schema_id, name=name, encoding=ENCODING, data=schema).write(self._copies)
        channel = self._writer.register_channel(sample.key, encoding, schema_id, metadata)
        copy = Channel(id=channel, topic=sample.key, message_encoding=encoding, metadata=metadata, schema_id=schema_id)
        copy.write(self._copies)
        known = _Channel(channel, self.counts.setdefault(below, LossCounter()), type_ is None)
        self._channels[sample.key, sample.encoding] = known
        return known


def below_robot(key: str) -> str:
    """A key without root and robot's name."""
    root, _, rest = key.partition("/")
    return rest.partition("/")[2] if root == ROOT else key
