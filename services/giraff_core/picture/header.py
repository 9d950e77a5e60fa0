"""What a JPEG or PNG says of itself, read before a decoder sees it. No decoder here.

A decoder takes memory and time by the size that the header names, and 300 bytes can name 32 000 x 32 000 px. So the
pictures that others made are judged here first. What cannot be judged is refused.
"""

import re
import struct
from typing import Final, NamedTuple

MOST_PIXELS: Final = 16 << 20
"""Of any picture. A decoder takes up to ten bytes for each."""
_MOST_TIMES: Final = 4
"""By which each side may exceed that of the camera's table: a device may give larger pictures, which are scaled."""
_MOST_SEGMENTS: Final = 1000
"""Number of segments before the first scan. Each takes time, and a photo with all its profiles has some hundred."""
_MOST_SCANS: Final = 64
"""Number of scans. Encoders write up to 20. Each may be 12 bytes long, and costs a pass over the whole picture."""
_BLOCK: Final = 8
"""px. Side of a block of a JPEG."""
_FILL: Final = b"\x80"
"""Each pixel of a block for which a decoder has no data. In colours those at its edge may differ."""

_PNG: Final = b"\x89PNG\r\n\x1a\n"
_PNG_SIZE: Final = struct.Struct(">8x8sII")
_PNG_FIRST: Final = b"\0\0\0\x0dIHDR"
_JPEG: Final = b"\xff\xd8\xff"
_MARKER: Final = re.compile(rb"\xff([^\x00\xff])")
"""As libjpeg finds it: bytes before it are skipped, and 0xff may be repeated."""
_LONELY: Final = frozenset({0x01, *range(0xD0, 0xD8)})
"""Markers without a segment."""
_START: Final = 0xD8
_END: Final = 0xD9
_SCAN: Final = 0xDA
_FRAMES: Final = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}
"""SOF0 to SOF15. The three others are tables and a reserved one."""
_SEQUENTIAL: Final = frozenset({0xC0, 0xC1})
_FRAME: Final = struct.Struct(">xHHB")
"""Height, width and number of components."""
_END_MARKER: Final = b"\xff\xd9"
_SCAN_MARKER: Final = b"\xff\xda"
_DAMAGED: Final = "its header is damaged"


class HeaderError(ValueError):
    """This picture must not reach a decoder. The message says why."""


class Header(NamedTuple):
    """A picture that may be decoded if it `fits`."""

    width: int
    """px."""
    height: int
    """px."""
    data: bytes
    """The picture up to its end. A JPEG whose end marker is missing has it here."""
    is_ended: bool
    """Whether its own end marker was there. If not, decode it and ask `is_cut`."""

    def fits(self, width: int, height: int) -> bool:
        """Return whether it is small enough to be decoded for a camera with this size in the robot file, px."""
        is_near = self.width <= _MOST_TIMES * width and self.height <= _MOST_TIMES * height
        return is_near and self.width * self.height <= MOST_PIXELS

    @property
    def last_block(self) -> tuple[slice, slice]:
        """Rows and columns of the block that a JPEG's data tell last."""
        return slice((self.height - 1) // _BLOCK * _BLOCK, None), slice((self.width - 1) // _BLOCK * _BLOCK, None)

    def is_cut(self, last_block: bytes) -> bool:
        """Return whether data are missing, and not the end marker alone. `last_block`: its pixels, decoded in grey.

        A decoder fills blocks without data with the middle grey. So where the last block holds anything else, all data
        were there. A whole picture without its end marker whose last block is exactly so grey counts as cut, too.
        """
        return not self.is_ended and not last_block.strip(_FILL)


def read_picture(data: bytes) -> Header:
    """Read the header of a JPEG or PNG. Raises HeaderError."""
    if not data.startswith(_PNG):
        return read_jpeg(data)
    if len(data) < _PNG_SIZE.size:
        raise HeaderError(_DAMAGED)
    first, width, height = _PNG_SIZE.unpack_from(data)
    if first != _PNG_FIRST or not width * height:
        raise HeaderError(_DAMAGED)
    return Header(width, height, data, is_ended=True)


def read_jpeg(data: bytes) -> Header:
    """Read the header of a JPEG. Raises HeaderError.

    Thumbnails stand within segments, which are skipped by their length.
    """
    if not data.startswith(_JPEG):
        raise HeaderError("it is no JPEG")
    frame: tuple[int, bytes] | None = None
    at = len(_JPEG) - 1
    for _ in range(_MOST_SEGMENTS):
        if (found := _MARKER.search(data, at)) is None:
            break
        code, at = found[1][0], found.end()
        if code in _LONELY:
            continue
        length = int.from_bytes(data[at : at + 2], "big")
        if code in {_START, _END} or length < 2 or at + length > len(data):
            break
        body, at = data[at + 2 : at + length], at + length
        if code in _FRAMES:
            if frame is not None:
                raise HeaderError("it names two sizes")
            frame = code, body
        elif code == _SCAN:
            if frame is None or len(frame[1]) < _FRAME.size or not body:
                break
            return _up_to_its_end(data, at, frame[0], _FRAME.unpack_from(frame[1]), body[0])
    raise HeaderError(_DAMAGED)


def _up_to_its_end(data: bytes, at: int, code: int, frame: tuple[int, ...], scanned: int) -> Header:
    """Find the end of a JPEG. `at`: where the data of its first scan begin; `scanned`: number of components in it.

    A missing end marker is added only where one scan holds all, so that the last block comes last.
    """
    height, width, components = frame
    if not width * height:  # some name the height behind the first scan, which libjpeg does not read
        raise HeaderError("it names no size")
    end = data.find(_END_MARKER, at)
    is_ended = end >= 0
    if is_ended:
        data = data[: end + len(_END_MARKER)]
    scans = 1 + data.count(_SCAN_MARKER, at)
    if scans > _MOST_SCANS:
        raise HeaderError(f"it has {scans} scans")
    if not is_ended:
        if code not in _SEQUENTIAL or scans > 1 or scanned != components:
            raise HeaderError("it is torn: its end is missing")
        data = data.rstrip(b"\0")
        data += (b"\0" if data.endswith(b"\xff") else b"") + _END_MARKER
    return Header(width, height, data, is_ended)
