"""A device that counts: each packet tells when its first byte left, so that a test knows how old it is."""

from typing import Final

from giraff_core.fresh_bytes import FreshBytes
from giraff_schemas.messages import RobotTime

PACKET: Final = 4
"""Bytes: a mark, and the packet's number in three digits of 7 bits."""
BYTE_US: Final = 250
PACKET_US: Final = PACKET * BYTE_US


class CountingDevice:
    """Sends a byte each 250 us, packet number N from N ms on."""

    def __init__(self) -> None:
        self.sent = 0
        self.received = b""

    def bytes_until(self, now_us: int) -> bytes:
        begin, self.sent = self.sent, now_us // BYTE_US
        numbers = range(begin // PACKET, self.sent // PACKET + 1)
        packets = b"".join(bytes((0xFF, each >> 14 & 0x7F, each >> 7 & 0x7F, each & 0x7F)) for each in numbers)
        at = begin % PACKET
        return packets[at : at + self.sent - begin]

    def receive(self, data: bytes) -> int:
        self.received += data
        return len(data)


def packets(fresh: FreshBytes) -> list[tuple[int, RobotTime | None]]:
    """Cut the whole packets off; return when the first byte of each left, in us, and its tick."""
    found = []
    while len(fresh.data) >= PACKET:
        if fresh.data[0] != 0xFF:
            fresh.cut(1)
            continue
        data, tick = fresh.cut(PACKET)
        found.append(((data[1] << 14 | data[2] << 7 | data[3]) * PACKET_US, tick))
    return found
