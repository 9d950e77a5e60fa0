"""The ring's packets: a mark, a distance in mm of each sensor (0: nothing within reach), and a checksum."""

import struct
from typing import Final

import msgspec

from giraff_schemas.framing import crc16
from giraff_schemas.ring import SENSORS, Distances

_PACKET: Final = struct.Struct(f"<B{SENSORS}HH")
_MARK: Final = 0xA5


def packet_length(data: bytearray) -> int:
    """Return how many bytes to cut off: a packet's, 1 of rubbish, 0 while more must come."""
    if not data or (data[0] == _MARK and len(data) < _PACKET.size):
        return 0
    return 1 if distances(bytes(data[: _PACKET.size])) is None else _PACKET.size


def distances(packet: bytes) -> Distances | None:
    """Return m of each sensor; None: these bytes are no packet."""
    if len(packet) != _PACKET.size or packet[0] != _MARK:
        return None
    _, *found, checksum = _PACKET.unpack(packet)
    if checksum != crc16(packet[:-2]):
        return None
    metres: Distances = msgspec.convert([mm / 1000 or None for mm in found], Distances)
    return metres
