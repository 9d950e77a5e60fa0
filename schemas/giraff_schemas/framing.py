"""Frames on a serial line: COBS(body + CRC-16/CCITT-FALSE of body, low byte first) + 0x00."""

import binascii
from collections.abc import Mapping
from typing import Final

from giraff_schemas.wire import FRAME_CLASSES, Frame

_CRC_SIZE: Final = 2
_LONGEST_BLOCK: Final = 254  # of a COBS code: longer bodies would need more than one code byte of overhead


def crc16(body: bytes) -> int:
    """CRC-16/CCITT-FALSE (check value 0x29B1)."""
    return binascii.crc_hqx(body, 0xFFFF)


def encode(body: bytes) -> bytes:
    """A body as it goes on the line, with the 0x00 that ends it."""
    data = body + crc16(body).to_bytes(_CRC_SIZE, "little")
    if len(data) >= _LONGEST_BLOCK:
        raise ValueError(f"a frame of {len(body)} bytes is too long for the wire")
    return b"".join([bytes((len(part) + 1,)) + part for part in data.split(b"\0")]) + b"\0"


def _decode_cobs(encoded: bytes) -> bytes | None:
    """The bytes that were encoded (without the 0x00 at the end), or None when no encoder wrote this."""
    data, length = bytearray(encoded), len(encoded)
    at = 0
    while at < length:
        code = encoded[at]  # never 0: that ends a frame
        data[at] = 0  # what each code byte stands for, but the first
        at += code
    return bytes(data[1:]) if at == length else None


class Decoder:
    """Frames out of a byte stream. Damage costs the frame it hits and is counted; the next 0x00 mends."""

    def __init__(self, frames: Mapping[int, type[Frame]] = FRAME_CLASSES) -> None:
        """`frames`: those of the line, by their type."""
        self._frames = frames
        self._longest_encoded = 1 + max(frame.layout.size for frame in frames.values()) + _CRC_SIZE
        self.crc_errors = 0
        self.shape_errors = 0  # not COBS, of no known type, or not of its type's length
        self._unfinished = b""

    def feed(self, data: bytes) -> list[Frame]:
        """The frames that end in data, in their order."""
        if not data:
            return []
        *ended, unfinished = (self._unfinished + data).split(b"\0")
        # One byte too many is enough to know a frame for too long.
        self._unfinished = unfinished[: self._longest_encoded + 1]
        return [frame for part in ended if part and (frame := self._decode(part)) is not None]

    @property
    def missing(self) -> int:
        """Bytes that the frame under way still lacks, its 0x00 among them; 0 when none is, or it is of no known kind.

        One that is torn ends sooner, but not as a frame.
        """
        # No kind is 0, so COBS leaves it as it is: the first code, 2 or more, stands before it.
        code, kind = self._unfinished[:1], self._unfinished[1:2]
        known = self._frames.get(kind[0]) if kind and code > b"\1" else None
        return 0 if known is None else max(0, 1 + known.layout.size + _CRC_SIZE + 1 - len(self._unfinished))

    def _decode(self, encoded: bytes) -> Frame | None:
        data = _decode_cobs(encoded) if len(encoded) <= self._longest_encoded else None
        if data is None or len(data) <= _CRC_SIZE:
            self.shape_errors += 1
            return None
        body = data[:-_CRC_SIZE]
        if crc16(body) != int.from_bytes(data[-_CRC_SIZE:], "little"):
            self.crc_errors += 1
            return None
        kind = self._frames.get(body[0])
        if kind is None or len(body) != kind.layout.size:
            self.shape_errors += 1
            return None
        return kind.unpack(body)
