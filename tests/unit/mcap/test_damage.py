"""A damaged recording gives all that can be read, and says how much is missing, and where."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import pytest
from mcap.opcode import Opcode

from giraff_mcap.layout import MAGIC, Layout, Part, look_through
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
    return Gap(since=round((number * 10 - 1) * 0.01, 6), until=until, samples=samples)


def rounded(found: Gap) -> Gap:
    return Gap(round(found.since, 6), None if found.until is None else round(found.until, 6), found.samples)


ROWS: dict[str, tuple[Damage, list[Gap], int]] = {
    "a middle chunk": (flip(in_data(3)), [gap(3)], 90),
    "the last chunk": (flip(in_data(9)), [gap(9)], 90),
    "two chunks": (both(flip(in_data(3)), flip(in_data(7))), [gap(3), gap(7)], 80),
    "a chunk's length, too much": (flip(lambda parts: parts[3].offset + 7), [gap(3)], 90),
    "a chunk's length, into later chunks": (flip(lambda parts: parts[3].offset + 2), [], 100),
    "a chunk's compression": (flip(lambda parts: parts[3].offset + 41), [gap(3)], 90),
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
    writer, missing = repair(path, tmp_path / "repaired.mcap")
    assert missing == unread
    assert sum(count.samples for count in writer.totals.values()) == readable
    repaired = Recording(tmp_path / "repaired.mcap")
    assert [each.text in repaired.ended_by for each in unread.gaps] == [True] * len(gaps)
    assert [sample.payload for sample in repaired.samples()] == [sample.payload for sample in samples]


def test_without_the_first_chunk_the_index_names_the_keys(tmp_path: Path) -> None:
    path, unread = damaged(tmp_path, flip(in_data(0))), Unread()
    assert [sample.seq for sample in Recording(path).samples(unread=unread)] == list(range(10, 100))
    assert [each.samples for each in unread.gaps] == [10]


@pytest.mark.parametrize("offset", range(9, 2000, 79))
def test_no_flipped_bit_is_passed_over_in_silence(tmp_path: Path, offset: int) -> None:
    """Whatever it hits: all samples are read as they were, or some are told to be missing."""
    path, unread = damaged(tmp_path, lambda data, _: data.__setitem__(-offset, data[-offset] ^ 0x04)), Unread()
    samples = list(Recording(path).samples(unread=unread))
    whole = {sample.payload for batch in range(CHUNKS) for sample in ten(batch * 10)}
    assert {sample.payload for sample in samples} <= whole
    assert len(samples) == 100 or unread


def damaged(tmp_path: Path, damage: Damage) -> Path:
    """A recording of ten chunks with ten samples each, with this damage."""
    path = tmp_path / "a.mcap"
    record(path, *(ten(first * 10) for first in range(CHUNKS)))
    with path.open("rb") as file:
        layout: Layout = look_through(file)
    assert [part.messages for part in layout.parts] == [10] * CHUNKS
    data = bytearray(path.read_bytes())
    assert data[layout.parts[3].offset] == Opcode.CHUNK
    damage(data, layout.parts)
    path.write_bytes(data)
    return path
