"""Packets become turns: each ray where it looked, and the sectors that tell nothing."""

import math
import random
from collections.abc import Callable, Iterator
from typing import Final

import pytest

from giraff_core.senses import LaserScanner
from giraff_scan.ld19 import Packet, cut_packets, packet_of
from giraff_scan.policy import Turn, Turns
from giraff_schemas.messages import RobotTime
from giraff_schemas.scan import NO_ECHO, NOT_MEASURED, OWN, RAYS
from tests.support.ld19 import PACKET_S, Buffer, packet

Room = Callable[[float], int]
"""mm that the scanner measures at so many degrees clockwise from its zero."""
MOUNT: Final = LaserScanner(x=0.0, y=0.0, yaw=0.0, own=())
TICK: Final = RobotTime(epoch=5, robot_ns=1)


def packets(room: Room, seconds: float, speed: float = 3600.0, begin: float = 200.0) -> Iterator[tuple[float, Packet]]:
    """Yield packets with the moment of their last point, s."""
    step = speed / 4500.0
    for number in range(round(seconds / PACKET_S)):
        start = begin + 12 * step * number
        read = packet_of(packet(start, [room((start + step * each) % 360.0) for each in range(12)], 0, speed))
        assert read is not None
        yield number * PACKET_S + 11 / 4500, read


def turns_of(stream: Iterator[tuple[float, Packet]], scanner: LaserScanner = MOUNT) -> list[Turn]:
    turns = Turns(scanner)
    found = (turns.add(each, round(at * 1e9), TICK) for at, each in stream)
    return [turn for turn in found if turn is not None]


def ramp(angle: float) -> int:
    return 1000 + round(10 * angle)


@pytest.mark.parametrize("speed", [2700.0, 3600.0, 4500.0])
def test_each_ray_is_where_it_looked_and_when(speed: float) -> None:
    turn = turns_of(packets(ramp, 0.6, speed))[1]
    whole = 360.0 / speed
    assert turn.duration == pytest.approx(whole, abs=0.0005)
    assert turn.begun_ns * 1e-9 == pytest.approx(160.0 / speed + whole, abs=0.0005)
    assert turn.tick == TICK
    assert turn.blind == ()
    told = [(ray, mm) for ray, mm in enumerate(turn.ranges) if mm != NOT_MEASURED]
    assert len(told) >= 0.79 * RAYS
    off = [mm - ramp(360.0 * ray / RAYS) for ray, mm in told]
    assert max(map(abs, off)) <= 8
    assert abs(sum(off)) <= 1.5 * len(off), "0.15 degrees"


def test_of_two_points_on_one_ray_the_nearer_one_counts() -> None:
    """At 8 turns a second there are 562 points on 450 rays. Every second one is near, those or the others."""
    near = 0
    for first in (0, 1):

        def room(angle: float, first: int = first) -> int:
            return 1000 if round(angle / 0.64) % 2 == first else 1500

        near += turns_of(packets(room, 0.4, speed=2880.0))[1].ranges.count(1000)
    assert near > 1.1 * RAYS


def test_no_turn_is_told_before_one_is_whole() -> None:
    assert turns_of(packets(ramp, 0.14)) == []
    assert len(turns_of(packets(ramp, 0.1501))) == 1


@pytest.mark.parametrize("upside_down", [False, True])
def test_rays_of_the_robots_own_parts_are_marked_on_the_side_where_they_are(upside_down: bool) -> None:
    left = math.radians(80.0), math.radians(100.0)
    scanner = LaserScanner(x=0.0, y=0.0, yaw=1.0, upside_down=upside_down, own=(left,))
    [turn, *_] = turns_of(packets(lambda _: 200, 0.3), scanner)
    marked = [360.0 * ray / RAYS for ray, mm in enumerate(turn.ranges) if mm == OWN | 200]
    middle = 90.0 if upside_down else 270.0
    assert min(marked) == pytest.approx(middle - 10.0, abs=0.9)
    assert max(marked) == pytest.approx(middle + 10.0, abs=0.9)
    assert turn.blind == ()


def test_a_dark_sector_is_blind_from_its_third_turn_on_until_it_answers() -> None:
    dark = [True]
    turns, told = Turns(MOUNT), []

    def room(angle: float) -> int:
        return NO_ECHO if dark[0] and 100.0 <= angle < 110.0 else 2000

    for at, each in packets(room, 1.0):
        dark[0] = at < 0.45
        if (turn := turns.add(each, round(at * 1e9), TICK)) is not None:
            told.append(turn.blind)
    assert told == [(), (), (10,), (10,), *[()] * 5]


@pytest.mark.parametrize("mm", [0, 30, 12_001])
def test_a_covered_window_and_what_is_too_far_are_no_echo(mm: int) -> None:
    assert [len(turn.blind) for turn in turns_of(packets(lambda _: mm, 0.5))] == [0, 0, 36, 36]


def test_a_sector_of_which_packets_are_lost_is_blind_at_once() -> None:
    stream = ((at, each) for at, each in packets(ramp, 0.5) if not (0.2 < at < 0.21))
    first, second, *others = turns_of(stream)
    assert (first.blind, second.blind) == ((), (20, 21, 22))
    assert {turn.blind for turn in others} == {()}


@pytest.mark.parametrize("stood", [0.1, 0.25, 2.0])
def test_no_turn_holds_rays_of_before_and_after_a_standstill(stood: float) -> None:
    """All after it meet something at 3 m."""
    before = [*packets(lambda _: 1000, 0.3)]
    after = [(at + 0.3 + stood, each) for at, each in packets(lambda _: 3000, 0.5, begin=330.0)]
    for turn in turns_of(iter(before + after)):
        met = {mm for mm in turn.ranges if mm != NOT_MEASURED}
        assert len(met) == 1 or turn.duration < 0.13


def test_a_motor_that_is_held_or_slow_is_told_and_its_turn_dropped() -> None:
    turns = Turns(MOUNT)
    for at, each in packets(ramp, 0.3):
        turns.add(each, round(at * 1e9), TICK)
    assert not turns.fault
    for speed, spread, word in ((2000.0, 4.9, "5.6 turns a second"), (3600.0, 0.0, "held"), (0.0, 0.0, "0.0 turns")):
        held = Packet(speed, 10.0, spread, (500,) * 12, 0)
        assert turns.add(held, 310_000_000, TICK) is None
        assert word in turns.fault.what
    assert turns_of(packets(ramp, 0.3), MOUNT)


def test_a_packet_whose_checksum_is_right_by_chance_puts_no_point() -> None:
    stream = [*packets(lambda _: 2000, 0.5)]
    at, wrong = stream[100]
    stream[100] = at, wrong._replace(start=(wrong.start + 90.0) % 360.0, ranges=(300,) * 12)
    assert not [mm for turn in turns_of(iter(stream)) for mm in turn.ranges if mm == 300]


@pytest.mark.parametrize(("damaged", "least", "most"), [(0.0005, 40_000, 150_000), (0.01, 0, 0)])
def test_many_damaged_bytes_put_no_point_that_was_not_there(damaged: float, least: int, most: int) -> None:
    """Ranges of the room are 2000 to 2359 mm; damaged ones would be anywhere. Of many nothing is told any more."""
    chance, turns, buffer = random.Random(3), Turns(MOUNT), Buffer()
    step, seen = 0.8, 0
    for number in range(400_000 // 47):
        start = 9.6 * number
        whole = bytearray(packet(start, [2000 + int((start + step * each) % 360.0) for each in range(12)], 0))
        for at in range(len(whole)):
            if chance.random() < damaged:
                whole[at] = chance.randrange(256)
        buffer.data += whole
        for read, _ in cut_packets(buffer):
            if read is None:
                turns.on_damaged()
                continue
            turn = turns.add(read, round(number * PACKET_S * 1e9), TICK)
            for mm in turn.ranges if turn else ():
                seen += mm < OWN
                assert mm == NOT_MEASURED or 2000 <= mm < 2360
    assert least <= seen <= most
    assert ("are damaged" in turns.fault.what) == (most == 0)


def test_packets_that_overlap_at_zero_end_one_turn_there() -> None:
    turns = Turns(MOUNT)
    for number in range(38):
        turns.add(Packet(3600.0, 9.6 * number % 360.0, 8.8, (900,) * 12, 0), round(number * PACKET_S * 1e9), TICK)
    at_ns = round(74 * PACKET_S * 1e9)
    first = turns.add(Packet(3600.0, 349.5, 11.0, (900,) * 12, 0), at_ns, TICK)
    again = turns.add(Packet(3600.0, 358.9, 9.6, (900,) * 12, 0), at_ns + 2_000_000, TICK)
    assert first is not None
    assert again is None
