"""Samples to bytes and back: MessagePack maps, with an encoding that names the schema."""

from __future__ import annotations

from functools import cache
from typing import Any

import msgspec

from giraff_schemas.frames import Transform
from giraff_schemas.health import Health
from giraff_schemas.text import plain
from giraff_schemas.topics import MOTION_QUERIES, PARAM_QUERIES, QUERIES, TOPICS, SampleT, Topic


class DecodeError(ValueError):
    """A payload that is not what its key carries. The message names the key and the field."""


_encoder = msgspec.msgpack.Encoder()


def stamped(sample: SampleT, seq: int, stamp_ns: int, instance: str) -> SampleT:
    """A copy of `sample` with what every sample starts with. Nothing is checked: that was done when it was made."""
    # Not `structs.replace`, which runs `__post_init__` again; every Struct has `__copy__`, which its stubs leave out.
    copy: SampleT = sample.__copy__()  # type: ignore[attr-defined]
    msgspec.structs.force_setattr(copy, "seq", seq)  # frozen, but nobody else has this one yet
    msgspec.structs.force_setattr(copy, "stamp_ns", stamp_ns)
    msgspec.structs.force_setattr(copy, "instance", instance)
    return copy


def encode(message: msgspec.Struct) -> bytes:
    return _encoder.encode(message)


def encoding_of(type_: type[msgspec.Struct]) -> str:
    """The encoding that travels with each sample: media type; schema."""
    return f"application/msgpack;giraff.{type_.__name__}"


def decode(topic: Topic[SampleT], key: str, payload: bytes, encoding: str | None = None) -> SampleT:
    """A sample of `topic` that arrived on `key`; DecodeError if it is none.

    `encoding`, when given and ours, must name the topic's schema.
    """
    if "*" in key:  # Zenoh lets one sample go to many keys at once, whatever each of them carries
        raise DecodeError(f"{key}: a sample goes to one key")
    if encoding is not None and ";giraff." in encoding and encoding != encoding_of(topic.schema):
        raise DecodeError(f"{key}: carries {encoding!r} where {encoding_of(topic.schema)!r} belongs")
    try:
        sample: SampleT = _decoder(topic.schema).decode(payload)
    except msgspec.ValidationError as error:
        raise DecodeError(f"{key}: not a {topic.schema.__name__}: {plain(error)}") from error
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:  # text that is none, nesting without end
        raise DecodeError(f"{key}: not MessagePack ({len(payload)} bytes): {plain(error)}") from error
    if not sample.instance:
        raise DecodeError(f"{key}: not a {topic.schema.__name__}: `instance` is missing or empty")
    if topic.names and (said := getattr(sample, topic.names)) != topic.name_in(key):
        raise DecodeError(f"{key}: says {said!r} as its `{topic.names}`, which its key does not")
    return sample


@cache
def _decoder(type_: type[msgspec.Struct]) -> msgspec.msgpack.Decoder[Any]:
    return msgspec.msgpack.Decoder(type_)


# All of them here, where one thread runs: msgspec begins to use what it knows of a type, and of the types in it, before
# that is complete. Of Zenoh's threads that decoded their first samples at one moment, one read NULL, which ended the
# process.
for _type in (
    *(topic.schema for topic in TOPICS),
    *(type_ for query in (*QUERIES, *MOTION_QUERIES, *PARAM_QUERIES) for type_ in (query.request, query.answer)),
    Health,
    Transform,
):
    _decoder(_type)
