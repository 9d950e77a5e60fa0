"""Finds the parts of an MCAP file that can be read, whatever is damaged between them. See https://mcap.dev/spec.

The file is looked through from record to record, without unpacking any. Where a record makes no sense, the search goes
on at the next chunk. The index at the end is used only when its checksum is right: then it names channels and counts.
"""

import struct
import zlib
from collections.abc import Iterator, Mapping
from io import BytesIO
from typing import IO, Final

import lz4.frame
import msgspec
import zstandard
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, ChunkIndex, Footer, Message, Metadata, Statistics
from mcap.stream_reader import CRCValidationError, breakup_chunk

MAGIC: Final = b"\x89MCAP0\r\n"
DAMAGE: Final = (
    McapError,
    CRCValidationError,
    zstandard.ZstdError,
    struct.error,
    RuntimeError,
    ValueError,
    EOFError,
    KeyError,
)
_LARGEST: Final = 1 << 26
"""Bytes of a record: a damaged length must not fill the memory."""
_RUN: Final = 1 << 22
"""Bytes of messages outside of any chunk that are read at a time."""
_BLOCK: Final = 1 << 16
"""Bytes that are searched at first. Each later block has twice as many, up to `_RUN`."""
_RECORD: Final = struct.Struct("<BQ")
_PRIVATE: Final = 0x80
"""The first opcode that any program may use for itself."""
_COMPRESSED: Final = (b"\x04\x00\x00\x00zstd", b"\x03\x00\x00\x00lz4")
"""Bytes of each chunk that has these compressions, with their length before them."""
_TO_COMPRESSED: Final = _RECORD.size + 28
"""Bytes from the beginning of a chunk to its compression."""
_FOOTER: Final = _RECORD.size + 20


class Part(msgspec.Struct):
    """A chunk, or messages outside of any chunk."""

    offset: int
    size: int
    since_ns: int
    """ns since 1970. Time of the first message."""
    in_chunk: bool
    messages: int | None = None
    """Number of messages by its own index. None: it has no index."""


class Layout(msgspec.Struct):
    """What is where in a file."""

    parts: list[Part] = []
    holes: list[int] = []
    """Offsets at which the file makes no sense."""
    channels: dict[int, Channel] = {}
    """Channels that are named outside of any chunk."""
    names_all: bool = False
    """An index with a right checksum names all channels, and tells when each chunk begins."""
    metadata: dict[str, dict[str, str]] = {}
    messages: int | None = None
    """Number of messages in the file when it was closed. None: not known."""


def was_closed(file: IO[bytes]) -> bool:
    """Tell whether a file ends as one that was closed."""
    size = file.seek(0, 2)
    if size < 2 * len(MAGIC):
        return False
    file.seek(-len(MAGIC), 2)
    return file.read() == MAGIC


def look_through(file: IO[bytes]) -> Layout:
    """Find the parts of a file. Raises OSError."""
    found = Layout()
    end = file.seek(0, 2)
    if was_closed(file):
        end -= len(MAGIC)
    chunks, end = _read_summary(file, end, found)
    before, before_opcode, position = 0, 0, len(MAGIC)
    while position < end:
        file.seek(position)
        head = file.read(_RECORD.size)
        opcode, size = _RECORD.unpack(head) if len(head) == _RECORD.size else (0, 0)
        after = position + _RECORD.size + size
        if opcode == Opcode.MESSAGE_INDEX and before_opcode not in {Opcode.CHUNK, Opcode.MESSAGE_INDEX}:
            # It follows a chunk always, so this is one whose first byte is damaged.
            found.parts.append(Part(before, position - before, chunks.get(before, 0), in_chunk=True))
        is_end = opcode == Opcode.DATA_END and size == 4
        if is_end or not _is_known(opcode) or after > end or not _note_record(file, opcode, position, size, found):
            # The record before may have led astray: its length may be what is damaged.
            next_chunk = _next_chunk(file, before + 1, end, chunks)
            if is_end and next_chunk == end:
                break  # what follows is the index, which no checksum confirms
            found.holes.append(position)
            before, before_opcode, position = next_chunk, 0, next_chunk
            continue
        before, before_opcode, position = position, opcode, after
    for part in found.parts:
        part.since_ns = chunks.get(part.offset, part.since_ns)
    return found


def read_part(file: IO[bytes], part: Part) -> Iterator[Channel | Message]:
    """Unpack a part. Raises one of DAMAGE and MemoryError where it is damaged, and OSError."""
    file.seek(part.offset)
    data = file.read(part.size)
    chunk = Chunk("", data, message_end_time=0, message_start_time=0, uncompressed_crc=0, uncompressed_size=len(data))
    if part.in_chunk:
        chunk = Chunk.read(ReadDataStream(BytesIO(data[_RECORD.size :])))
        chunk.data, chunk.compression = _unpacked(chunk), ""
    for record in breakup_chunk(chunk, validate_crc=True):
        if isinstance(record, (Channel, Message)):
            yield record


def _unpacked(chunk: Chunk) -> bytes:
    """Return the records of a chunk. Its own word for their size is the limit."""
    size = chunk.uncompressed_size
    if size > _LARGEST:
        raise ValueError("a chunk that is larger than any")
    match chunk.compression:
        case "zstd":
            if zstandard.frame_content_size(chunk.data) not in {-1, size}:
                raise ValueError("a chunk of another size")
            return zstandard.decompress(chunk.data, size)
        case "lz4":
            return bytes(lz4.frame.LZ4FrameDecompressor().decompress(chunk.data, max_length=size))
        case _:
            return chunk.data


def _is_known(opcode: int) -> bool:
    return opcode >= _PRIVATE or opcode in Opcode.__members__.values()


def _note_record(file: IO[bytes], opcode: int, position: int, size: int, found: Layout) -> bool:
    """Note a record of the part of a file that holds data; False: it is damaged."""
    record, after = position + _RECORD.size, position + _RECORD.size + size
    if size > _LARGEST and opcode in {Opcode.CHUNK, Opcode.MESSAGE, Opcode.CHANNEL, Opcode.METADATA}:
        return False
    try:
        match opcode:
            case Opcode.CHUNK:
                file.seek(record)
                (since_ns,) = struct.unpack("<Q", file.read(8))
                found.parts.append(Part(position, after - position, since_ns, in_chunk=True))
            case Opcode.MESSAGE:
                _take_message(file, position, after, found.parts)
            case Opcode.MESSAGE_INDEX if found.parts:
                chunk = found.parts[-1]
                chunk.messages = (chunk.messages or 0) + max(0, size - 6) // 16
            case Opcode.CHANNEL:
                channel = Channel.read(_stream(file, record, size))
                found.channels.setdefault(channel.id, channel)
            case Opcode.METADATA:
                metadata = Metadata.read(_stream(file, record, size))
                found.metadata[metadata.name] = metadata.metadata
            case _:
                pass
    except DAMAGE:
        return False
    return True


def _take_message(file: IO[bytes], position: int, after: int, parts: list[Part]) -> None:
    """Note a message outside of any chunk, with its neighbours."""
    run = parts[-1] if parts else None
    if run is not None and not run.in_chunk and run.offset + run.size == position and run.size < _RUN:
        run.size, run.messages = after - run.offset, (run.messages or 0) + 1
        return
    file.seek(position + _RECORD.size + 6)
    (at_ns,) = struct.unpack("<Q", file.read(8))
    parts.append(Part(position, after - position, at_ns, in_chunk=False, messages=1))


def _read_summary(file: IO[bytes], end: int, found: Layout) -> tuple[dict[int, int], int]:
    """Note what the index at the end says, if its checksum is right; when each chunk begins, and where the data end.

    Chunks are named by their offset.
    """
    named: dict[int, Channel] = {}
    chunks: dict[int, int] = {}
    counted: Statistics | None = None
    try:
        footer_at = end - _FOOTER
        file.seek(footer_at)
        head = file.read(_FOOTER)
        opcode, size = _RECORD.unpack_from(head)
        footer = Footer.read(ReadDataStream(BytesIO(head[_RECORD.size :])))
        if (opcode, size) != (Opcode.FOOTER, 20) or not len(MAGIC) <= footer.summary_start < footer_at:
            return {}, end
        file.seek(footer.summary_start)
        summary = file.read(footer_at - footer.summary_start)
        if footer.summary_crc and zlib.crc32(summary + head[:-4]) != footer.summary_crc:
            return {}, end
        stream = ReadDataStream(BytesIO(summary))
        while stream.count < len(summary):
            opcode, size = stream.read1(), stream.read8()
            record = ReadDataStream(BytesIO(stream.read(size)))
            if opcode == Opcode.CHANNEL:
                channel = Channel.read(record)
                named[channel.id] = channel
            elif opcode == Opcode.STATISTICS:
                counted = Statistics.read(record)
            elif opcode == Opcode.CHUNK_INDEX:
                index = ChunkIndex.read(record)
                chunks[index.chunk_start_offset] = index.message_start_time
    except (*DAMAGE, OSError):
        return {}, end
    found.channels = named
    if counted is not None:
        found.messages = counted.message_count
        found.names_all = counted.channel_count == len(named) and counted.chunk_count == len(chunks) > 0
    return chunks, footer.summary_start


def _next_chunk(file: IO[bytes], start: int, end: int, chunks: Mapping[int, int]) -> int:
    """Find the next chunk; where it begins, or `end`."""
    overlap, length = _TO_COMPRESSED + 8, _BLOCK
    known = min((chunk for chunk in chunks if chunk >= start), default=end)
    file.seek(known)
    if file.read(1) == bytes([Opcode.CHUNK]):
        end = known  # none is searched beyond it
    at = start
    while at < end:
        file.seek(at)
        block = file.read(min(length, end - at))
        length = min(2 * length, _RUN)
        found = (_chunk_in(block, marker) for marker in _COMPRESSED)
        if places := [place for place in found if place is not None]:
            return at + min(places)
        if len(block) <= overlap:
            break
        at += len(block) - overlap
    return end


def _chunk_in(block: bytes, marker: bytes) -> int | None:
    """Return the place of the first chunk of a compression in a block."""
    place = block.find(marker, _TO_COMPRESSED)
    while place >= 0:
        if block[place - _TO_COMPRESSED] == Opcode.CHUNK:
            return place - _TO_COMPRESSED
        place = block.find(marker, place + 1)
    return None


def _stream(file: IO[bytes], offset: int, size: int) -> ReadDataStream:
    file.seek(offset)
    return ReadDataStream(BytesIO(file.read(size)))
