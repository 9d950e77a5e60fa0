"""Packets of the laser scanners LD06, LD19 and STL-19P (LDROBOT, "LD19 Development Manual V2.3"). No I/O here.

A packet has 47 bytes, little-endian: a mark, a length, the speed, the angle of its first point, twelve points, the
angle of the last one, a time in ms, and a CRC-8 with the polynomial 0x4D. Angles run clockwise, seen from above.
"""

import struct
from collections.abc import Iterator
from typing import Final, NamedTuple

from giraff_core.fresh_bytes import FreshBytes
from giraff_schemas.messages import RobotTime

SIZE: Final = 47
POINTS: Final = 12
WRAPS_MS: Final = 30_000
POINTS_PER_S: Final = 4500.0
"""Points that it measures at any speed of the motor."""
BAUD: Final = 230_400

MARK: Final = b"\x54\x2c"
_PACKET: Final = struct.Struct("<2sHH36sHHB")
_DISTANCES: Final = struct.Struct("<" + "HB" * POINTS)
_CIRCLE: Final = 36_000
_POLYNOMIAL: Final = 0x4D


def _table() -> bytes:
    """Return the remainder of each byte."""
    remainders = []
    for byte in range(256):
        crc = byte
        for _ in range(8):
            crc = (crc << 1 ^ _POLYNOMIAL) & 0xFF if crc & 0x80 else crc << 1
        remainders.append(crc)
    return bytes(remainders)


_REMAINDERS: Final = _table()


class Packet(NamedTuple):
    """Twelve points that follow each other."""

    speed: float
    """deg/s, clockwise."""
    start: float
    """deg clockwise from the scanner's zero: its first point."""
    spread: float
    """deg from the first point to the last, clockwise, 0 to 360."""
    ranges: tuple[int, ...]
    """mm; 0: no echo."""
    ms: int
    """Time by the scanner's own clock, which begins anew every 30 s."""


def crc8(data: bytes) -> int:
    """Return the checksum of some bytes."""
    crc = 0
    for byte in data:
        crc = _REMAINDERS[crc ^ byte]
    return crc


def packet_length(data: bytearray) -> int:
    """Return how many bytes to cut off: those of a packet, those before the next one, or 0 while more must come."""
    at = data.find(MARK)
    if at:
        # The mark's first byte may be the last one that has come.
        return at if at > 0 else len(data) - data.endswith(MARK[:1])
    if len(data) < SIZE:
        return 0
    return SIZE if crc8(bytes(data[:SIZE])) == 0 else 1


def cut_packets(fresh: FreshBytes) -> Iterator[tuple[Packet | None, RobotTime | None]]:
    """Cut off all that has come; yield each packet with its tick, None for one whose checksum is wrong."""
    while length := packet_length(fresh.data):
        is_damaged = length == 1 and fresh.data.startswith(MARK)
        data, tick = fresh.cut(length)
        packet = packet_of(data)
        if packet is not None or is_damaged:
            yield packet, tick


def packet_of(data: bytes) -> Packet | None:
    """Return the packet that was cut off by its length; None: these bytes are none."""
    if len(data) != SIZE or not data.startswith(MARK):
        return None
    _, speed, start, points, end, ms, _ = _PACKET.unpack(data)
    spread = (end - start) % _CIRCLE / 100.0
    return Packet(float(speed), start % _CIRCLE / 100.0, spread, _DISTANCES.unpack(points)[::2], ms)
