"""Frames in Python, in C, and between the two."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import cffi
import pytest
from hypothesis import given
from hypothesis import strategies as st

from giraff_schemas.boards import BASE_BOARD
from giraff_schemas.framing import Decoder, crc16, encode
from giraff_schemas.wire import FRAME_CLASSES, DriveFrame, Frame, HelloRequestFrame, WheelsFrame
from tests.firmware.builds import FIRMWARE, shared_library

BODY_MAX = max(frame.layout.size for frame in BASE_BOARD.frames.values())
BITS = {"B": (0, 8), "H": (0, 16), "I": (0, 32), "Q": (0, 64), "h": (1, 16), "i": (1, 32)}


def integers(code: str) -> st.SearchStrategy[int]:
    signed, bits = BITS[code]
    low = -(1 << (bits - 1)) if signed else 0
    return st.integers(low, low + (1 << bits) - 1)


def values(kind: type[Frame]) -> st.SearchStrategy[Frame]:
    return st.tuples(*(integers(code) for code in kind.layout.format[2:])).map(lambda fields: kind(*fields))


frames = st.sampled_from(list(FRAME_CLASSES.values())).flatmap(values)


class CCodec:
    """The boards' codec."""

    def __init__(self, library: Path) -> None:
        self._ffi = cffi.FFI()
        self._ffi.cdef(
            f"""
            uint8_t frame_encode(const void *body, uint8_t n, uint8_t *line);
            struct frame_decoder {{ uint8_t bytes[{BODY_MAX + 3}]; uint8_t n; uint16_t errors; }};
            uint8_t frame_decode(struct frame_decoder *decoder, uint8_t byte);
            uint16_t crc16(const uint8_t *bytes, uint8_t n);
            """
        )
        self.lib: Any = self._ffi.dlopen(str(library))

    def encode(self, body: bytes) -> bytes:
        line = self._ffi.new("uint8_t[]", BODY_MAX + 4)
        return bytes(self._ffi.buffer(line, self.lib.frame_encode(body, len(body), line)))

    def decode(self, stream: bytes) -> tuple[list[bytes], int]:
        """The bodies, and how many errors were counted."""
        decoder: Any = self._ffi.new("struct frame_decoder *")
        bodies = [
            bytes(self._ffi.buffer(decoder.bytes, n)) for byte in stream if (n := self.lib.frame_decode(decoder, byte))
        ]
        return bodies, decoder.errors


@pytest.fixture(scope="module")
def c(tmp_path_factory: pytest.TempPathFactory) -> CCodec:
    sources = (FIRMWARE / "common" / f"{name}.c" for name in ("cobs", "crc", "frame"))
    includes = [FIRMWARE / name for name in ("common", "base", "boards/base")]
    return CCodec(shared_library(tmp_path_factory.mktemp("codec") / "codec.so", *sources, includes=includes))


def python_decode(stream: bytes) -> tuple[list[bytes], int]:
    decoder = Decoder()
    decoded = [frame.pack() for frame in decoder.feed(stream)]
    return decoded, decoder.crc_errors + decoder.shape_errors


def test_the_crc_is_ccitt_false(c: CCodec) -> None:
    assert crc16(b"123456789") == 0x29B1
    assert c.lib.crc16(b"123456789", 9) == 0x29B1


@given(frame=frames)
def test_both_sides_put_the_same_bytes_on_the_line(c: CCodec, frame: Frame) -> None:
    line = encode(frame.pack())
    assert line.count(0) == 1
    assert line.endswith(b"\0")
    assert c.encode(frame.pack()) == line


@given(sent=st.lists(frames, max_size=5))
def test_both_sides_read_what_either_has_written(c: CCodec, sent: list[Frame]) -> None:
    line = b"".join(encode(frame.pack()) for frame in sent)
    assert Decoder().feed(line) == sent
    assert c.decode(line) == ([frame.pack() for frame in sent], 0)


@given(body=st.binary(min_size=1, max_size=BODY_MAX))
def test_the_boards_carry_any_body(c: CCodec, body: bytes) -> None:
    assert c.decode(c.encode(body)) == ([body], 0)
    assert c.encode(body) == encode(body)


damage = st.one_of(
    st.binary(max_size=120),
    st.lists(frames, min_size=1, max_size=4).flatmap(
        lambda sent: st.tuples(
            st.just(b"".join(encode(frame.pack()) for frame in sent)),
            st.lists(st.tuples(st.integers(0, 60), st.integers(0, 255)), max_size=4),
        ).map(lambda line: mangled(*line))
    ),
)


def mangled(line: bytes, changes: list[tuple[int, int]]) -> bytes:
    changed = bytearray(line)
    for at, value in changes:
        changed[at % len(changed)] = value
    return bytes(changed)


@given(stream=damage)
def test_both_sides_agree_about_damage(c: CCodec, stream: bytes) -> None:
    """But that type and length, which a board's dispatch looks at, are not the C decoder's business."""
    bodies, errors = c.decode(stream)
    good = [body for body in bodies if body[0] in FRAME_CLASSES and len(body) == FRAME_CLASSES[body[0]].layout.size]
    assert (good, errors + len(bodies) - len(good)) == python_decode(stream)


@given(stream=st.binary(max_size=500), cut=st.integers(1, 50), frame=frames)
def test_the_decoder_survives_anything_and_mends_at_the_next_zero(stream: bytes, cut: int, frame: Frame) -> None:
    decoder = Decoder()
    for at in range(0, len(stream), cut):
        decoder.feed(stream[at : at + cut])
    assert decoder.feed(b"\0" + encode(frame.pack()))[-1] == frame


@given(sent=st.lists(frames, max_size=4), cut=st.integers(1, 50))
def test_frames_may_come_in_pieces(sent: list[Frame], cut: int) -> None:
    line = b"".join(encode(frame.pack()) for frame in sent)
    decoder = Decoder()
    assert [frame for at in range(0, len(line), cut) for frame in decoder.feed(line[at : at + cut])] == sent
    assert (decoder.crc_errors, decoder.shape_errors) == (0, 0)


def test_the_decoder_keeps_little_of_a_line_without_zeros() -> None:
    decoder = Decoder()
    for _ in range(1000):
        decoder.feed(b"\x01" * 1000)
    assert len(decoder._unfinished) < 100
    assert decoder.feed(b"\0") == []
    assert (decoder.crc_errors, decoder.shape_errors) == (0, 1)


def test_errors_are_told_apart() -> None:
    line = encode(DriveFrame(seq=1, boot_id=2, board_ms=3, left_level=4, right_level=5).pack())
    counts: dict[str, Callable[[Decoder], int]] = {
        "crc": lambda decoder: decoder.crc_errors,
        "shape": lambda decoder: decoder.shape_errors,
    }
    wrong = {
        "a changed byte": (line[:4] + bytes([line[4] ^ 0x10]) + line[5:], "crc"),
        "a COBS code beyond the end": (b"\x09\x01\x00", "shape"),
        "no body": (encode(b""), "shape"),
        "an unknown type": (encode(b"\x77\x00\x00"), "shape"),
        "a length of another type": (encode(HelloRequestFrame(seq=0).pack() + b"\x00"), "shape"),
        "longer than any frame": (encode(bytes(BODY_MAX + 1)), "shape"),
    }
    for name, (stream, kind) in wrong.items():
        decoder = Decoder()
        assert decoder.feed(stream) == [], name
        assert {key: count(decoder) for key, count in counts.items()} == {"crc": 0, "shape": 0} | {kind: 1}, name


def test_a_body_too_long_for_the_wire_is_refused() -> None:
    with pytest.raises(ValueError, match="too long"):
        encode(bytes(300))


def test_frames_have_the_layout_of_the_packed_structs() -> None:
    wheels = WheelsFrame(*range(1, 20))
    assert wheels.pack()[:7] == b"\x02" + (1).to_bytes(2, "little") + (2).to_bytes(4, "little")
    assert WheelsFrame.unpack(wheels.pack()) == wheels
