"""A recording is what was heard, byte for byte, for this project's reader and for the library's own."""

import errno
import os
from itertools import pairwise
from pathlib import Path
from typing import Any

import msgspec
import pytest
from mcap.reader import make_reader

from giraff_mcap import writing
from giraff_mcap.raw_sample import RawSample
from giraff_mcap.reading import Recording, RecordingError
from giraff_mcap.writing import RecordingWriter, schema_of
from giraff_schemas.codec import DecodeError, encode
from giraff_schemas.localization import FreeCells, MapWalls
from giraff_schemas.topics import MAP, OPERATOR_CMD_VEL, TOPICS, topic_of
from tests.unit.mcap.recordings import ABOUT, BEGAN_NS, ROBOT, heard, odometry, record, ten


def test_what_was_heard_is_read_byte_for_byte_and_as_evenly(tmp_path: Path) -> None:
    samples = ten()
    record(tmp_path / "a.mcap", samples[:4], samples[4:])
    recording = Recording(tmp_path / "a.mcap")
    read = list(recording.samples())
    assert [sample.payload for sample in read] == [sample.payload for sample in samples]
    assert {later.heard_ns - before.heard_ns for before, later in pairwise(read)} == {10_000_000}
    assert [(sample.seq, sample.stamp_ns) for sample in read] == [(s, 1_700_000_000_000_000_000 + s) for s in range(10)]
    assert read[3].decode() == odometry(3)
    assert {sample.encoding for sample in read} == {samples[0].encoding}
    assert (recording.robot, recording.whole, recording.ended_by) == (ROBOT, True, "test")
    assert recording.tables() == {"robot": {"name": ROBOT}}
    assert recording.seconds == pytest.approx(0.09)


def test_bytes_within_a_part_of_a_sample_are_read_as_they_were_heard(tmp_path: Path) -> None:
    """A map tells where the robot can be, in bits. JSON has no bytes, so a recording keeps them as text."""
    free = FreeCells(left=0.0, bottom=0.0, side=0.1, columns=3, rows=5, bits=b"\xa5\xfe")
    for number, there in enumerate((free, None)):
        here = MapWalls(instance="l", map="flat", walls=(), free=there)
        record(path := tmp_path / f"{number}.mcap", [heard(here, BEGAN_NS, MAP)])
        [sample] = Recording(path).samples()
        assert (sample.payload, sample.decode()) == (encode(here), here)


def test_the_librarys_own_reader_finds_an_index_and_a_schema(tmp_path: Path) -> None:
    record(tmp_path / "a.mcap", ten(), ten(10))
    with (tmp_path / "a.mcap").open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        summary = reader.get_summary()
        assert summary is not None
        assert summary.statistics is not None
        assert summary.statistics.message_count == 20
        assert len(summary.chunk_indexes) == 2
        ((schema, channel, message), *_) = reader.iter_messages()
        assert schema is not None
        assert (schema.name, schema.encoding, channel.topic) == (
            "giraff.Odometry",
            "jsonschema",
            f"giraff/{ROBOT}/odom",
        )
        assert set(msgspec.json.decode(message.data)) == set(msgspec.json.decode(schema.data)["properties"])


def every_field(schema: dict[str, Any]) -> list[dict[str, Any]]:
    """The schema, and those of all that is in it."""
    inner = [*schema.get("properties", {}).values(), *([schema["items"]] if "items" in schema else [])]
    return [schema, *(field for part in inner for field in every_field(part))]


@pytest.mark.parametrize("topic", TOPICS, ids=lambda topic: topic.key)
def test_each_field_of_a_schema_has_a_type_as_foxglove_wants_it(topic: Any) -> None:
    fields = every_field(msgspec.json.decode(schema_of(topic.schema)))
    assert len(fields) > 3
    for field in fields:
        assert field["type"] in {"object", "array", "string", "number", "integer", "boolean"}
        assert not {"$ref", "anyOf", "prefixItems"} & set(field)
        assert field["type"] != "object" or "properties" in field
        assert field.get("items", {}).get("type") != "array"


def test_a_lost_sample_is_counted_by_its_maker(tmp_path: Path) -> None:
    samples = [sample for seq, sample in enumerate(ten()) if seq not in {0, 3, 4}]
    samples += [heard(odometry(seq, "another"), samples[-1].at_ns + seq + 1) for seq in range(5)]
    writer = record(tmp_path / "a.mcap", samples)
    assert (writer.totals["odom"].samples, writer.totals["odom"].lost) == (12, 2)
    assert Recording(tmp_path / "a.mcap").counts == writer.totals


ANYTHING = {
    "new/list": msgspec.msgpack.encode([1]),
    "new/bytes": msgspec.msgpack.encode({"image": b"\x00\xff", "far": float("inf"), 7: None}),
    "new/torn": b"\xc1",
    "new/ext": b"\xd4\x01\x00",
    "new/json": b'{"x": NaN}',
}


def test_what_is_no_sample_of_ours_is_kept_byte_for_byte_or_named(tmp_path: Path) -> None:
    (sample,) = ten()[:1]
    path = tmp_path / "a.mcap"
    strangers = [sample._replace(key=f"giraff/{ROBOT}/{key}", payload=payload) for key, payload in ANYTHING.items()]
    writer = record(path, [sample, *strangers, *2 * [sample._replace(payload=b"\xc1")]])
    assert {key: left.samples for key, left in writer.unread.left_out.items()} == {f"giraff/{ROBOT}/odom": 2}
    read = {recorded.key: recorded for recorded in Recording(path).samples(["new/*"])}
    assert {key: recorded.payload for key, recorded in read.items()} == ANYTHING
    assert {recorded.encoding for recorded in read.values()} == {sample.encoding}
    assert read["new/list"].content() == [1]
    with pytest.raises(DecodeError, match="new/torn"):
        read["new/torn"].content()


def test_a_file_that_was_cut_off_anywhere_is_read_up_to_the_last_whole_chunk(tmp_path: Path) -> None:
    record(tmp_path / "a.mcap", ten(), ten(10), close=False)
    data = (tmp_path / "a.mcap").read_bytes()
    counts = set()
    for length in range(len(data), 400, -37):
        cut = tmp_path / "cut.mcap"
        cut.write_bytes(data[:length])
        try:
            recording = Recording(cut)
        except RecordingError as error:
            assert "nothing is in it" in str(error)  # noqa: PT017  only then
            continue
        assert not recording.whole
        counts.add(len(list(recording.samples())))
    assert counts == {10, 20}


def test_more_keys_than_a_file_can_hold_end_no_recording(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(writing, "_MOST_CHANNELS", 3)
    path, [sample, *_] = tmp_path / "a.mcap", ten()
    writer = record(path, [sample, *(sample._replace(key=f"giraff/{ROBOT}/new/{number}") for number in range(5))])
    assert {key: left.samples for key, left in writer.unread.left_out.items()} == {"?": 3}
    assert len(list(Recording(path).samples())) == 3


def test_one_key_may_come_in_several_encodings(tmp_path: Path) -> None:
    path, [sample, *_] = tmp_path / "a.mcap", ten()
    said = [
        sample._replace(key=f"giraff/{ROBOT}/new", encoding=encoding, at_ns=sample.at_ns + number)
        for number, encoding in enumerate(("text/plain", "application/json", "text/plain"))
    ]
    record(path, said)
    assert [recorded.encoding for recorded in Recording(path).samples()] == [one.encoding for one in said]


def test_a_file_that_is_there_is_not_written_over(tmp_path: Path) -> None:
    (tmp_path / "a.mcap").write_text("precious")
    with pytest.raises(FileExistsError):
        RecordingWriter(tmp_path / "a.mcap", {})
    assert (tmp_path / "a.mcap").read_text() == "precious"


def test_a_full_disk_costs_what_did_not_fit_and_nothing_else(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    writer = RecordingWriter(tmp_path / "a.mcap", ABOUT)
    writer.add(ten())
    writer.sync()
    write, calls = os.write, []

    def full(descriptor: int, data: bytes) -> int:
        calls.append(data)
        if len(calls) > 1:
            raise OSError(errno.ENOSPC, "No space left on device")
        return write(descriptor, data[:20])

    monkeypatch.setattr(os, "write", full)
    writer.add(ten(10))
    with writer, pytest.raises(OSError, match="No space left"):
        writer.sync()
    recording = Recording(tmp_path / "a.mcap")
    assert (recording.whole, len(list(recording.samples()))) == (False, 10)


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (None, "No such file"),
        (b"", "not an MCAP"),
        (b"#ROSBAG V2.0\n", "not an MCAP"),
        (b"\x89MCAP0\r\n", "nothing is in it"),
        (b"\x89MCAP0\r\n" + b"\xff" * 200 + b"\x89MCAP0\r\n", "damaged"),
    ],
)
def test_what_is_no_recording_is_told_in_one_line(tmp_path: Path, content: bytes | None, says: str) -> None:
    path = tmp_path / "a.mcap"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(RecordingError, match=says) as told:
        Recording(path)
    assert "\n" not in str(told.value)


def test_nothing_waits_for_a_pipe(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "a.mcap")
    for path in (tmp_path, tmp_path / "a.mcap"):
        with pytest.raises(RecordingError, match="it is no file, but a folder, a pipe or a device"):
            Recording(path)


def test_a_key_is_found_in_the_table() -> None:
    assert topic_of("cmd_vel/joystick") is OPERATOR_CMD_VEL
    assert topic_of("cmd_vel/a/b") is None
    assert topic_of("nothing") is None


def test_the_size_that_is_told_is_never_less_than_the_closed_files(tmp_path: Path) -> None:
    writer = RecordingWriter(tmp_path / "a.mcap", {})
    for first in range(0, 500, 10):
        writer.add(ten(first))
        writer.sync()
    told = writer.size
    writer.close("test")
    assert (tmp_path / "a.mcap").stat().st_size <= told


def test_samples_come_in_the_order_in_which_they_were_heard(tmp_path: Path) -> None:
    samples: list[RawSample] = ten()
    record(tmp_path / "a.mcap", samples[::-1])
    record(tmp_path / "b.mcap", samples[1::2], samples[::2])
    for name in ("a.mcap", "b.mcap"):
        assert [sample.seq for sample in Recording(tmp_path / name).samples()] == list(range(10))
