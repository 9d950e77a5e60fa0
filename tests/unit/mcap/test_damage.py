"""A damaged recording gives all that can be read, and says how much is missing, and where."""

import tracemalloc
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path

import lz4.frame
import pytest
import zstandard
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import Chunk

from giraff_mcap.layout import DAMAGE, MAGIC, Layout, Part, look_through, read_part
from giraff_mcap.reading import Recording
from giraff_mcap.repair import repair
from giraff_mcap.unread import Gap, Unread
from tests.unit.mcap.recordings import record, ten

CHUNKS = 10
Damage = Callable[[bytearray, Sequence[Part]], object]


def flip(place: Callable[[Sequence[Part]], int], bit: int = 0x10) -> Damage:
    def damage(data: bytearray, parts: Sequence[Part]) -> None:
        data[place(parts)] ^= bit

    return damage


def cut(place: Callable[[Sequence[Part]], int]) -> Damage:
    def damage(data: bytearray, parts: Sequence[Part]) -> None:
        del data[place(parts) :]

    return damage


def zeros(data: bytearray, parts: Sequence[Part]) -> None:
    """Clear a block that begins in one chunk and ends in the next, as a bad disk does."""
    data[parts[4].offset + 200 : parts[5].offset + 100] = bytes(parts[5].offset + 100 - parts[4].offset - 200)


def both(*damages: Damage) -> Damage:
    def damage(data: bytearray, parts: Sequence[Part]) -> None:
        for one in damages:
            one(data, parts)

    return damage


def index_after(part: Part) -> int:
    """Where the first record after a chunk begins."""
    return part.offset + part.size


def in_data(number: int) -> Callable[[Sequence[Part]], int]:
    return lambda parts: parts[number].offset + 150


def gap(number: int, samples: int | None = 10) -> Gap:
    """Of one chunk of ten samples that are 10 ms apart."""
    until = None if number == CHUNKS - 1 else round(number * 0.1 + 0.1, 6)
    since = round(number * 0.1 - 0.01, 6)
    return Gap(since, until, samples) if number else Gap(None, 0.0, samples)


def rounded(found: Gap) -> Gap:
    since, until = (None if time is None else round(time, 6) for time in (found.since, found.until))
    return Gap(since, until, found.samples)


ROWS: dict[str, tuple[Damage, list[Gap], int]] = {
    "the first chunk": (flip(in_data(0)), [gap(0)], 90),
    "a middle chunk": (flip(in_data(3)), [gap(3)], 90),
    "the last chunk": (flip(in_data(9)), [gap(9)], 90),
    "two chunks": (both(flip(in_data(3)), flip(in_data(7))), [gap(3), gap(7)], 80),
    "a chunk's length, too much": (flip(lambda parts: parts[3].offset + 7), [gap(3)], 90),
    "a chunk's length, into later chunks": (flip(lambda parts: parts[3].offset + 2), [], 100),
    "a chunk's compression": (flip(lambda parts: parts[3].offset + 41), [gap(3)], 90),
    "what a chunk's first byte says it is": (flip(lambda parts: parts[3].offset, 0x80), [], 100),
    "the time in a chunk's head": (flip(lambda parts: parts[3].offset + 9 + 5), [], 100),
    "the time in the first chunk's head": (flip(lambda parts: parts[0].offset + 9 + 5), [], 100),
    "the index of a chunk": (flip(lambda parts: index_after(parts[3])), [], 100),
    "the file's own index": (flip(lambda parts: index_after(parts[9]) + 200), [], 100),
    "the footer": (flip(lambda _: -30), [], 100),
    "the header": (flip(lambda _: len(MAGIC) + 5), [], 100),
    "an index and a chunk": (
        both(flip(lambda parts: index_after(parts[9]) + 200), flip(in_data(3))),
        [gap(3)],
        90,
    ),
    "cut in the last chunk": (cut(in_data(9)), [gap(9, None)], 90),
    "cut there, and a middle chunk": (both(flip(in_data(3)), cut(in_data(9))), [gap(3), gap(9, None)], 80),
    "a block of zeros": (zeros, [Gap(since=0.39, until=0.6, samples=20)], 80),
}


@pytest.mark.parametrize(("damage", "gaps", "readable"), ROWS.values(), ids=list(ROWS))
def test_all_that_can_be_read_is_and_the_rest_is_told(
    tmp_path: Path, damage: Damage, gaps: list[Gap], readable: int
) -> None:
    path, unread = damaged(tmp_path, damage), Unread()
    samples = list(Recording(path).samples(unread=unread))
    assert len(samples) == readable
    assert [sample.seq for sample in samples] == sorted(sample.seq for sample in samples)
    assert [rounded(each) for each in unread.gaps] == gaps
    writer = repair(path, tmp_path / "repaired.mcap")
    assert writer.unread == unread
    assert sum(count.samples for count in writer.totals.values()) == readable
    repaired = Recording(tmp_path / "repaired.mcap")
    assert [each.text in repaired.ended_by for each in unread.gaps] == [True] * len(gaps)
    assert [sample.payload for sample in repaired.samples()] == [sample.payload for sample in samples]


AT_THE_END = {"the file's own index", "an index and a chunk", "the footer"}
OPEN = {name: row for name, row in ROWS.items() if name not in AT_THE_END}


@pytest.mark.parametrize(("damage", "gaps", "readable"), OPEN.values(), ids=list(OPEN))
def test_without_an_end_all_that_can_be_read_is_too(
    tmp_path: Path, damage: Damage, gaps: list[Gap], readable: int
) -> None:
    """The first bytes that are told of need not be missing: nothing tells how many samples there were."""
    path, unread = damaged(tmp_path, damage, close=False), Unread()
    samples = list(Recording(path).samples(unread=unread))
    assert [sample.seq for sample in samples] == sorted({sample.seq for sample in samples})
    assert len(samples) == readable
    assert bool(gaps) <= bool(unread)


def test_a_repair_of_a_repair_tells_the_same(tmp_path: Path) -> None:
    first, second = tmp_path / "first.mcap", tmp_path / "second.mcap"
    repair(damaged(tmp_path, flip(in_data(3))), first)
    writer = repair(first, second)
    assert [rounded(each) for each in writer.unread.gaps] == [gap(3)]
    assert sum(count.samples for count in writer.totals.values()) == 90
    list(Recording(second).samples(unread=(unread := Unread())))
    assert unread == writer.unread


def test_recordings_that_were_joined_are_read_whole(tmp_path: Path) -> None:
    record(tmp_path / "a.mcap", ten())
    record(tmp_path / "b.mcap", ten(10), ten(20))
    (tmp_path / "c.mcap").write_bytes((tmp_path / "b.mcap").read_bytes() + (tmp_path / "a.mcap").read_bytes())
    assert [sample.seq for sample in Recording(tmp_path / "c.mcap").samples()] == list(range(30))


@pytest.mark.parametrize(("compression", "compress"), [("zstd", zstandard.compress), ("lz4", lz4.frame.compress)])
def test_a_chunk_that_unpacks_to_more_than_it_says_is_damaged(
    tmp_path: Path, compression: str, compress: Callable[[bytes], bytes]
) -> None:
    stream, path = RecordBuilder(), tmp_path / "chunk"
    chunk = Chunk(compression, compress(bytes(100_000_000)), 0, 0, 0, uncompressed_size=1000)
    chunk.write(stream)
    path.write_bytes(stream.end())
    part = Part(0, path.stat().st_size, 0, in_chunk=True)
    tracemalloc.start()
    with path.open("rb") as file, suppress(*DAMAGE):
        list(read_part(file, part))
    assert tracemalloc.get_traced_memory()[1] < 10_000_000
    tracemalloc.stop()


def damaged(tmp_path: Path, damage: Damage, *, close: bool = True) -> Path:
    """A recording of ten chunks with ten samples each, with this damage."""
    path = tmp_path / "a.mcap"
    record(path, *(ten(first * 10) for first in range(CHUNKS)), close=close)
    with path.open("rb") as file:
        layout: Layout = look_through(file)
    assert [part.messages for part in layout.parts] == [10] * CHUNKS
    data = bytearray(path.read_bytes())
    assert data[layout.parts[3].offset] == Opcode.CHUNK
    damage(data, layout.parts)
    path.write_bytes(data)
    return path
