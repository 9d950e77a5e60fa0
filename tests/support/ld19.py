"""Packets of an LD19 as bytes, written down from its manual: no formula of the parser that reads them."""

from collections.abc import Sequence
from typing import Final

from giraff_core.fresh_bytes import FreshBytes

PACKET_S: Final = 12 / 4500


def crc8(data: bytes) -> int:
    """Return the remainder of a division by x^8 + x^6 + x^3 + x^2 + 1, bit by bit."""
    remainder = 0
    for bit in range(8 * len(data)):
        is_set = data[bit // 8] >> (7 - bit % 8) & 1
        remainder = ((remainder << 1) ^ (0x14D if (remainder >> 7) ^ is_set else 0)) & 0xFF
    return remainder


def packet(start: float, mm: Sequence[int], ms: int, speed: float = 3600.0, step: float | None = None) -> bytes:
    """Return a packet of twelve ranges. `start`: deg clockwise; `step`: deg between two points."""
    end = start + 11 * (speed / 4500.0 if step is None else step)
    numbers = (round(speed), round(start % 360 * 100) % 36_000)
    points = b"".join(each.to_bytes(2, "little") + b"\xc8" for each in mm)
    tail = (round(end % 360 * 100) % 36_000, ms % 30_000)
    body = b"\x54\x2c" + b"".join(each.to_bytes(2, "little") for each in numbers) + points
    body += b"".join(each.to_bytes(2, "little") for each in tail)
    return body + bytes([crc8(body)])


class Buffer(FreshBytes):
    """Bytes that have come from no port, without ticks."""

    def __init__(self) -> None:
        self.data = bytearray()

    def cut(self, length: int) -> tuple[bytes, None]:
        data = bytes(self.data[:length])
        del self.data[:length]
        return data, None
