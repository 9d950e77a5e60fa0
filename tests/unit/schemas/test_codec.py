"""Samples to bytes and back: what is said comes back, and what is not a sample is named."""

import math
import re
from itertools import product
from typing import Any

import msgpack
import msgspec
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from giraff_schemas import messages as m
from giraff_schemas.bumper import Bump
from giraff_schemas.camera import CameraHold
from giraff_schemas.codec import DecodeError, decode, decode_request, encode, encoding_of, stamped
from giraff_schemas.format import FORMAT
from giraff_schemas.health import Health
from giraff_schemas.motion import MotionHold
from giraff_schemas.requests import UNREADABLE_STOP
from giraff_schemas.topics import (
    BASE,
    BATTERY,
    CMD_VEL,
    DRIVING_QUERIES,
    ESTOP_ENGAGE,
    MOTION_CANCEL,
    OPERATOR_CMD_VEL,
    PARAM_QUERIES,
    PLACES_CANCEL,
    QUERIES,
    RANGE,
    TICK,
    TILT,
    TOPICS,
    Query,
    Topic,
)
from tests.unit.schemas.samples import an_example, messages

KEY = "giraff/sim-test/some/key"
TICK_SAMPLE = m.Tick(seq=3, stamp_ns=4, instance="a1", epoch=7, robot_ns=5)


def as_in_key(topic: Topic[Any]) -> dict[str, str]:
    """The field that must agree with KEY."""
    return {topic.names: topic.name_in(KEY)} if topic.names else {}


def as_json(message: object) -> object:
    """A message as JSON has it, which knows no bytes."""
    return msgspec.json.decode(msgspec.json.encode(message))


def packed(value: object) -> bytes:
    """As another language's MessagePack library would."""
    payload = msgpack.packb(value)
    assert isinstance(payload, bytes)
    return payload


def refusal(topic: Topic[Any], payload: bytes, encoding: str | None = None) -> str:
    """What the decoder says about a payload that it must refuse."""
    with pytest.raises(DecodeError) as refused:
        decode(topic, KEY, payload, encoding)
    message = str(refused.value)
    assert message.startswith(f"{KEY}: ")
    return message


@pytest.mark.parametrize("topic", TOPICS, ids=lambda topic: topic.key)
@settings(max_examples=10, derandomize=True)
@given(data=st.data())
def test_what_is_encoded_is_decoded_and_a_plain_map_to_a_reader_without_the_schemas(
    topic: Topic[Any], data: st.DataObject
) -> None:
    sample = msgspec.structs.replace(data.draw(messages(topic.schema)), **as_in_key(topic))
    payload = encode(sample)
    assert decode(topic, KEY, payload, encoding_of(topic.schema)) == sample
    plain = msgpack.unpackb(payload)
    assert as_json(plain) == as_json(sample)
    assert list(plain)[:3] == ["seq", "stamp_ns", "instance"]
    whole = stamped(sample, 1 << 40, 1 << 41, "another")
    assert encode(sample) == payload, "stamping leaves the maker's sample as it was"
    assert whole == msgspec.structs.replace(sample, seq=1 << 40, stamp_ns=1 << 41, instance="another")


@given(health=messages(Health))
def test_health_comes_back_too(health: Health) -> None:
    assert msgspec.msgpack.decode(encode(health), type=Health) == health


def test_a_map_that_any_library_packs_is_a_sample() -> None:
    for topic in TOPICS:
        example = an_example(topic.schema) | as_in_key(topic)
        sample = decode(topic, KEY, packed(example))
        assert isinstance(sample, topic.schema)
        assert msgpack.unpackb(encode(sample)) == example, topic.key


def test_the_encoding_names_format_and_schema() -> None:
    assert encoding_of(m.Tick) == f"application/msgpack;giraff.{FORMAT}.Tick"
    assert encoding_of(m.GuardedCommand) == f"application/msgpack;giraff.{FORMAT}.GuardedCommand"


@pytest.mark.parametrize("encoding", [None, "", "application/msgpack", "zenoh/bytes", encoding_of(m.Tick)])
def test_an_encoding_that_claims_nothing_else_is_read(encoding: str | None) -> None:
    assert decode(TICK, KEY, encode(TICK_SAMPLE), encoding) == TICK_SAMPLE


def test_another_schema_in_the_encoding_is_refused_though_the_map_would_fit() -> None:
    message = refusal(TICK, encode(TICK_SAMPLE), encoding_of(m.Tilt))
    assert f"carries '{encoding_of(m.Tilt)}' where '{encoding_of(m.Tick)}' belongs" in message
    assert "install" not in message


@pytest.mark.parametrize("other", ["Tick", f"{FORMAT - 1}.Tick", f"{FORMAT + 1}.Tick"])
def test_another_format_is_refused_and_both_are_named(other: str) -> None:
    """A field may have another name there, and what is left out may have a default."""
    message = refusal(TICK, encode(TICK_SAMPLE), f"application/msgpack;giraff.{other}")
    assert f"giraff.{other}' where '{encoding_of(m.Tick)}' belongs; install the same version on all mach" in message


@pytest.mark.parametrize("query", [*QUERIES, *DRIVING_QUERIES, *PARAM_QUERIES], ids=lambda query: query.key)
@pytest.mark.parametrize("payload", [b"", b"\xc1", b"\x91" * 5000, None], ids=lambda payload: str(payload)[:9])
def test_a_request_that_cannot_be_read_is_refused_but_a_stop_is_a_stop(
    query: Query[Any, Any], payload: bytes | None
) -> None:
    """`None`: it could be read, and is of another format."""
    encoding = None if payload is not None else f"application/msgpack;giraff.{FORMAT + 1}.{query.request.__name__}"
    if query in {ESTOP_ENGAGE, MOTION_CANCEL, PLACES_CANCEL}:
        assert decode_request(query, KEY, payload or b"\x80", encoding) == query.unreadable
        return
    with pytest.raises(DecodeError, match=query.request.__name__):
        decode_request(query, KEY, b"\x80" if payload is None else payload, encoding)


def required_fields() -> list[tuple[Topic[Any], str]]:
    return [
        (topic, field.encode_name)
        for topic in TOPICS
        for field in msgspec.structs.fields(topic.schema)
        if field.required
    ]


def test_a_missing_field_is_named() -> None:
    for topic, field in required_fields():
        example = an_example(topic.schema)
        del example[field]
        message = refusal(topic, packed(example))
        assert topic.schema.__name__ in message
        assert f"`{field}`" in message


def test_a_field_of_the_wrong_type_is_named() -> None:
    for topic, field in required_fields():
        wrong = "text is no picture" if field in {"jpeg", "ranges"} else b"bytes are nowhere else right"
        message = refusal(topic, packed(an_example(topic.schema) | {field: wrong}))
        assert f"{field} must be " in message, topic.key


def test_what_every_sample_starts_with_is_checked() -> None:
    for topic, field in product(TOPICS, ("seq", "stamp_ns", "instance")):
        message = refusal(topic, packed(an_example(topic.schema) | {field: [1]}))
        assert f"{field} must be " in message, topic.key


def test_a_wrong_field_inside_another_is_named_by_its_path() -> None:
    example = an_example(m.BaseState)
    example["board"] = example["board"] | {"accepted": "many"}
    assert "board.accepted must be " in refusal(BASE, packed(example))


def paths_of_floats(example: dict[Any, Any]) -> list[tuple[str | int, ...]]:
    """Where a map holds a float, at whatever depth."""
    found: list[tuple[str | int, ...]] = []
    for name, value in example.items():
        if isinstance(value, float):
            found.append((name,))
        if isinstance(value, dict):
            found += [(name, *path) for path in paths_of_floats(value)]
        if isinstance(value, list):
            found += [(name, *path) for path in paths_of_floats(dict(enumerate(value)))]
    return found


def spoilt(values: Any, path: tuple[str | int, ...], number: float) -> Any:
    """A copy of nested maps and lists with `number` at `path`."""
    if not path:
        return number
    copy = values.copy()
    copy[path[0]] = spoilt(values[path[0]], path[1:], number)
    return copy


FLOATS = [(topic, path) for topic in TOPICS for path in paths_of_floats(an_example(topic.schema))]


def test_a_number_that_is_not_finite_is_refused_by_name() -> None:
    for (topic, path), number in product(FLOATS, (math.nan, math.inf, -math.inf)):
        message = refusal(topic, packed(spoilt(an_example(topic.schema), path, number)))
        name = next(part for part in reversed(path) if isinstance(part, str))
        assert re.search(rf"\b{name}\b", message), (topic.key, path)
        assert "finite" in message


def test_every_message_with_a_float_is_in_that_test() -> None:
    without = {Bump, CameraHold, m.Tick, m.Lease, m.EStop, m.SerialLine, m.SerialWrite, MotionHold}
    assert {topic.schema for topic, _ in FLOATS} == {topic.schema for topic in TOPICS} - without


def test_a_sample_of_nobody_is_refused() -> None:
    for topic in TOPICS:
        example = an_example(topic.schema)
        assert "`instance`" in refusal(topic, packed(example | {"instance": ""})), topic.key
        del example["instance"]
        assert "`instance`" in refusal(topic, packed(example)), topic.key


def test_unknown_fields_are_ignored() -> None:
    for topic in TOPICS:
        example = an_example(topic.schema) | as_in_key(topic)
        newer = example | {"a_later_field": {"of": ["any", 1.5, None]}}
        assert decode(topic, KEY, packed(newer)) == decode(topic, KEY, packed(example)), topic.key


def test_a_name_that_is_not_the_keys_is_refused() -> None:
    """Whoever may publish on one operator's key has no other operator's name."""
    for topic in (OPERATOR_CMD_VEL, RANGE, OPERATOR_CMD_VEL.at("key"), RANGE.at("key")):
        example = an_example(topic.schema) | {topic.names: "another"}
        assert f"says 'another' as its `{topic.names}`" in refusal(topic, packed(example))


@pytest.mark.parametrize("key", ["giraff/sim-test/**", "giraff/*/tick", "**", "giraff/sim-test/cmd_vel/*"])
def test_one_sample_for_many_keys_is_refused(key: str) -> None:
    for topic in TOPICS:
        with pytest.raises(DecodeError, match="goes to one key"):
            decode(topic, key, packed(an_example(topic.schema) | as_in_key(topic)))


@pytest.mark.parametrize(
    "payload",
    [
        b"",
        b"\xc1",
        b"garbage",
        b"\xdf\xff\xff\xff\xff\xa1a",
        b"\x91" * 100_000 + b"\xc0",
        encode(TICK_SAMPLE)[:-1],
        encode(TICK_SAMPLE) + b"\0",
        encode(TICK_SAMPLE).replace(b"\xa2a1", b"\xa2\xff\xfe"),
        b"\x87" + encode(TICK_SAMPLE)[1:] + b"\xa1z" + b"\x91" * 100_000 + b"\xc0",
    ],
    ids=["empty", "no opcode", "text", "huge map", "deep", "cut off", "more", "not UTF-8", "deep unknown field"],
)
def test_bytes_that_are_no_sample_are_refused_with_the_key(payload: bytes) -> None:
    refusal(TICK, payload)


@given(payload=st.binary(max_size=200))
def test_no_bytes_do_anything_but_decode_or_be_refused(payload: bytes) -> None:
    for topic in TOPICS:
        refusal(topic, payload)


@given(data=st.data())
def test_no_damage_does_anything_but_decode_or_be_refused(data: st.DataObject) -> None:
    topic = data.draw(st.sampled_from(TOPICS))
    whole = packed(an_example(topic.schema))
    at = data.draw(st.integers(0, len(whole) - 1))
    damaged = whole[:at] + data.draw(st.binary(min_size=1, max_size=3)) + whole[at + 1 :]
    said = ""
    try:
        decode(topic, KEY, damaged)
    except DecodeError as error:
        said = str(error)
    assert said == "" or said.startswith(f"{KEY}: ")


@pytest.mark.parametrize(("state", "range_"), [("echo", None), ("clear", 1.0), ("fault", 1.0), ("clear", 0.0)])
def test_a_distance_goes_with_an_echo_and_with_nothing_else(state: str, range_: float | None) -> None:
    message = refusal(RANGE, packed(an_example(m.Range) | {"state": state, "range": range_}))
    assert state in message


@pytest.mark.parametrize(
    ("topic", "field", "value"),
    [
        (RANGE, "state", "maybe"),
        (TILT, "status", "fine"),
        (OPERATOR_CMD_VEL, "source", "ghost"),
        (CMD_VEL, "source", ""),
    ],
)
def test_a_word_that_is_not_in_the_vocabulary_is_refused(topic: Topic[Any], field: str, value: str) -> None:
    assert f"{field} cannot be " in refusal(topic, packed(an_example(topic.schema) | {field: value}))


@pytest.mark.parametrize(
    "time", [{"epoch": -1, "robot_ns": 5}, {"epoch": 1 << 32, "robot_ns": 5}, {"epoch": 7, "robot_ns": -1}]
)
def test_a_moment_that_the_boards_could_not_carry_is_refused(time: dict[str, int]) -> None:
    assert "epoch" in refusal(OPERATOR_CMD_VEL, packed(an_example(m.DriveCommand) | {"tick": time}))
    assert "epoch" in refusal(TICK, packed(an_example(m.Tick) | time))


def test_a_tick_of_nobodys_epoch_is_refused() -> None:
    assert "epoch" in refusal(TICK, packed(an_example(m.Tick) | {"epoch": 0}))


def test_stamping_fills_in_what_every_sample_starts_with_and_nothing_else() -> None:
    battery = m.Battery(voltage=25.0)
    assert stamped(battery, 5, 6, "d4") == m.Battery(seq=5, stamp_ns=6, instance="d4", voltage=25.0)
    assert decode(BATTERY, KEY, encode(stamped(battery, 5, 6, "d4"))).seq == 5


def test_samples_cannot_be_changed() -> None:
    with pytest.raises(AttributeError):
        TICK_SAMPLE.seq = 4  # type: ignore[misc]


@pytest.mark.parametrize("type_", [m.DriveCommand, m.GuardedCommand])
@pytest.mark.parametrize(
    ("linear_x", "angular_z", "neutral"), [(0.0, 0.0, True), (0.1, 0.0, False), (0.0, -0.1, False)]
)
def test_neutral_is_no_motion_at_all(
    type_: type[m.DriveCommand | m.GuardedCommand], linear_x: float, angular_z: float, neutral: bool
) -> None:
    twist = {"linear_x": linear_x, "angular_z": angular_z}
    command = msgspec.convert(an_example(type_) | twist, type_)
    assert command.neutral is neutral


def test_who_looks_through_the_network_asks_for_no_stop() -> None:
    for key in ("**", "giraff/**", "giraff/sim-test/estop/*"):
        with pytest.raises(DecodeError, match="a request names one key"):
            decode_request(ESTOP_ENGAGE, key, None, None)
        assert decode_request(ESTOP_ENGAGE, key, encode(UNREADABLE_STOP), None) == UNREADABLE_STOP
    assert decode_request(ESTOP_ENGAGE, KEY, None, None) == UNREADABLE_STOP
