"""Packets of an LD19: read, found among rubbish, and refused when they are damaged."""

import random
from typing import Final

from giraff_scan.ld19 import SIZE, Packet, cut_packets, packet_of
from tests.support.ld19 import Buffer, packet

# The example of the manual, "LD19 Development Manual V2.3", section 4: a packet as it came from one.
MANUALS: Final = bytes.fromhex(
    "54 2C 68 08 AB 7E E0 00 E4 DC 00 E2 D9 00 E5 D5 00 E3 D3 00 E4 D0 00 E9 CD 00 E4 CA 00 E2 C7 00 E9 C5 00 E5 C2 00"
    "E5 C0 00 E5 BE 82 3A 1A 50"
)


def cut(data: bytes) -> list[Packet]:
    """Return the packets in some bytes, which come seven at a time."""
    buffer, found = Buffer(), []
    for at in range(0, len(data), 7):
        buffer.data += data[at : at + 7]
        found += [packet for packet, _ in cut_packets(buffer) if packet is not None]
    assert len(buffer.data) < SIZE
    return found


def test_the_packet_of_the_manual() -> None:
    read = packet_of(MANUALS)
    assert read is not None
    assert (read.speed, read.start, read.ms) == (2152.0, 324.27, 6714)
    assert read.ranges[:3] == (224, 220, 217)
    assert read.ranges[-1] == 192
    assert round(read.spread, 2) == 10.43


def test_packets_are_found_among_rubbish_and_in_pieces() -> None:
    chance = random.Random(1)
    whole = [packet(9.6 * number, [1000 + number] * 12, 3 * number) for number in range(37)]
    rubbish = [chance.randbytes(chance.randrange(60)) + b"\x54" * (number % 3) for number in range(37)]
    found = cut(b"".join(part for pair in zip(rubbish, whole, strict=True) for part in pair))
    assert [each.ranges[0] for each in found if each.ranges[0] in range(1000, 1037)] == [*range(1000, 1037)]
    assert found[-1].start == 345.6


def test_one_whose_bit_was_flipped_is_none_and_loses_no_other() -> None:
    chance = random.Random(2)
    for _ in range(500):
        first, second = packet(0.0, [500] * 12, 0), packet(9.6, [600] * 12, 3)
        damaged = bytearray(first)
        damaged[chance.randrange(SIZE)] ^= 1 << chance.randrange(8)
        assert [each.ranges[0] for each in cut(bytes(damaged) + second + b"\x54")] == [600]
