"""Samples to bytes and back: MessagePack maps, with an encoding that names the schema."""

import re
from functools import cache
from typing import Any, Final

import msgspec

from giraff_schemas.format import FORMAT, SAME_VERSION
from giraff_schemas.frames import Transform
from giraff_schemas.health import Health
from giraff_schemas.text import plain
from giraff_schemas.topics import DRIVING_QUERIES, PARAM_QUERIES, QUERIES, TOPICS, Query, RequestT, SampleT, Topic
from giraff_schemas.trouble import Trouble


class DecodeError(ValueError):
    """A payload that is not what its key carries. The message names the key and the field."""

    def __init__(self, what: str, remedy: str = "") -> None:
        self.trouble = Trouble(what, remedy)
        super().__init__(str(self.trouble))


_encoder = msgspec.msgpack.Encoder()
_FORMAT: Final = re.compile(r";giraff\.([0-9]+)\.")


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
    """Return the encoding that travels with each message: media type; format and schema."""
    return f"application/msgpack;giraff.{FORMAT}.{type_.__name__}"


def require_encoding(key: str, type_: type[msgspec.Struct], encoding: str | None) -> None:
    """Raise DecodeError where an encoding of ours names another format or schema than `type_` has here.

    Names of fields differ between two formats, and a field that is left out may have a default: so none is read.
    """
    if encoding is None or ";giraff." not in encoding or encoding == encoding_of(type_):
        return
    named = _FORMAT.search(encoding)
    is_other = named is None or int(named[1]) != FORMAT
    what = f"{key}: carries {encoding!r} where {encoding_of(type_)!r} belongs"
    raise DecodeError(what, SAME_VERSION if is_other else "")


def decode(topic: Topic[SampleT], key: str, payload: bytes, encoding: str | None = None) -> SampleT:
    """A sample of `topic` that arrived on `key`; DecodeError if it is none.

    `encoding`, when given and ours, must name this format and the topic's schema.
    """
    if "*" in key:  # Zenoh lets one sample go to many keys at once, whatever each of them carries
        raise DecodeError(f"{key}: a sample goes to one key")
    require_encoding(key, topic.schema, encoding)
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


def decode_request(query: Query[RequestT, Any], key: str, payload: bytes | None, encoding: str | None) -> RequestT:
    """Return what is asked on `key`. Raise DecodeError where it cannot be read, and the query does not say instead.

    `payload`: None: there is none. A program that looks through the network asks many keys so, and for nothing.
    """
    if payload is None and "*" in key:
        raise DecodeError(f"{key}: a request names one key, or carries what it asks for")
    try:
        require_encoding(key, query.request, encoding)
        try:
            request: RequestT = _decoder(query.request).decode(payload or b"")
        except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError) as error:
            raise DecodeError(f"not a {query.request.__name__}: {plain(error)}") from error
    except DecodeError:
        if query.unreadable is None:
            raise
        return query.unreadable
    return request


@cache
def _decoder(type_: type[msgspec.Struct]) -> msgspec.msgpack.Decoder[Any]:
    return msgspec.msgpack.Decoder(type_)


# All of them here, where one thread runs: msgspec begins to use what it knows of a type, and of the types in it, before
# that is complete. Of Zenoh's threads that decoded their first samples at one moment, one read NULL, which ended the
# process.
for _type in (
    *(topic.schema for topic in TOPICS),
    *(type_ for query in (*QUERIES, *DRIVING_QUERIES, *PARAM_QUERIES) for type_ in (query.request, query.answer)),
    Health,
    Transform,
):
    _decoder(_type)
