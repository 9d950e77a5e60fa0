"""Bytes of a device that echoes no tick: nothing that has waited passes, and none carries a tick newer than it is."""

from collections.abc import Callable, Iterator
from pathlib import Path
from random import Random
from types import SimpleNamespace
from typing import Any, cast

import pytest

from giraff_core.fresh_bytes import FreshBytes
from giraff_node import Node
from giraff_node.boards.byte_link import ByteLink
from giraff_schemas.messages import RobotTime, Tick
from tests.support.serial_device import PACKET_US, CountingDevice, packets
from tests.unit.node.ports import FakePort

TICK_US = 20_000
WAIT_US = 50_000
DELAY_US = 7_000
BOOTED_NS = 10**12
"""The machine of the device runs longer than that of base."""


class Bench:
    """A device, the kernel's buffer, base's ticks, and a process that can stand still before and after each call."""

    def __init__(self, stall_us: Callable[[], int] = lambda: 0, most: int = 4095) -> None:
        """`most`: bytes of one read."""
        self.now_us = self.read_us = 0
        self.opened = 1
        self.is_held = False
        """The adapter gives up nothing."""
        self._stall_us, self._most = stall_us, most
        self._device, self._waiting = CountingDevice(), b""
        self._next_tick_us = 200_000
        self.fresh = FreshBytes(ByteLink("", 0, self.clock, cast("Any", self)), self.clock, delay=DELAY_US * 1e-6)

    def clock(self) -> int:
        self.now_us += self._stall_us()
        told_ns = self.now_us * 1000 + BOOTED_NS
        self.now_us += self._stall_us()
        return told_ns

    def ticks(self) -> Iterator[Tick]:
        while self._next_tick_us <= self.now_us:
            self._next_tick_us += TICK_US
            yield Tick(epoch=1, robot_ns=(self._next_tick_us - TICK_US) * 1000)
            self.now_us += self._stall_us()

    def turn(self, after_us: int) -> list[tuple[int, RobotTime | None]]:
        """Have a turn after a while; return what it was given, once it was found to be fresh."""
        self.now_us += after_us
        self.fresh.update(self.now_us * 1e-6, self.ticks())
        found = packets(self.fresh)
        for begun_us, tick in found:
            assert self.read_us - (begun_us + PACKET_US) <= WAIT_US
            assert tick is None or tick.robot_ns <= (begun_us - DELAY_US) * 1000
        return found

    # A port, as `SerialLink` is one.

    def keep_open(self, now: float) -> bool:
        del now
        opened, self.opened = self.opened, 0
        return bool(opened)

    def flush(self) -> None:
        """Nothing waits."""

    def read(self) -> bytes:
        self.now_us += self._stall_us()
        self.read_us = self.now_us
        if not self.is_held:
            self._waiting += self._device.bytes_until(self.now_us)
        data, self._waiting = self._waiting[: self._most], self._waiting[self._most :]
        return data


def running(most: int = 4095) -> Bench:
    """Return a bench after its first second of turns."""
    bench = Bench(most=most)
    for _ in range(100):
        bench.turn(10_000)
    return bench


def test_a_prompt_service_is_given_all_of_it_each_with_a_tick_of_just_before() -> None:
    bench = running()
    found = [each for _ in range(100) for each in bench.turn(10_000)]
    begun = [us for us, _ in found]
    assert begun == list(range(begun[0], begun[0] + 1_000_000, PACKET_US))
    ages = [begun_us * 1000 - tick.robot_ns for begun_us, tick in found if tick is not None]
    assert len(ages) == len(found)
    assert max(ages) <= (DELAY_US + TICK_US + 2 * 10_000) * 1000
    assert bench.fresh.breaks == 1, "the port was opened"


def test_what_comes_for_50_ms_after_an_opening_is_dropped() -> None:
    bench = running()
    bench.turn(9_500)
    assert bench.fresh.data, "half a packet"
    bench.opened = 1
    opened_us = bench.now_us + 10_000
    found = [each for _ in range(20) for each in bench.turn(10_000)]
    assert opened_us + WAIT_US <= found[0][0] <= opened_us + WAIT_US + 10_000 + PACKET_US


@pytest.mark.parametrize("most", [4095, 7])
def test_after_a_gap_all_that_waited_is_dropped_and_what_an_adapter_held_too(most: int) -> None:
    bench = running(most)
    bench.turn(9_500)
    woken_us = bench.now_us + 51_000
    assert bench.turn(51_000) == []
    found = [each for _ in range(20) for each in bench.turn(10_000)]
    assert bench.fresh.breaks == 2
    assert woken_us + WAIT_US <= found[0][0] <= woken_us + WAIT_US + 10_000 + PACKET_US


def test_ticks_that_queued_up_are_on_nothing_that_came_before_them() -> None:
    bench = running()
    before_us = bench.now_us
    found = bench.turn(45_000)
    assert len(found) == 45
    assert all(tick is not None and tick.robot_ns <= (before_us - DELAY_US) * 1000 for _, tick in found)


def test_a_packet_has_the_tick_of_its_first_byte() -> None:
    bench = running()
    bench.turn(9_500)
    bench.is_held = True
    for _ in range(10):
        assert bench.turn(10_000) == []
    bench.is_held = False
    bench.fresh.update(0.0, bench.ticks())
    (begun_us, tick), *_ = packets(bench.fresh)
    assert bench.now_us - begun_us > 100_000
    assert tick is not None
    assert tick.robot_ns <= (begun_us - DELAY_US) * 1000


def test_with_fewer_than_25_turns_a_second_nothing_is_handed_on() -> None:
    bench = running()
    bench.turn(60_000)
    assert [bench.turn(51_000) for _ in range(20)] == [[]] * 20
    assert not bench.fresh.data


def test_so_much_at_once_that_the_kernel_stops_the_adapter_is_a_gap() -> None:
    bench = running()
    bench._waiting = bytes(3_900)
    assert bench.turn(1_000) == []
    assert bench.turn(10_000) == []
    assert bench.fresh.breaks == 2


def test_bytes_that_nobody_cuts_take_no_memory() -> None:
    bench = running()
    for _ in range(3_000):
        bench.now_us += 10_000
        bench.fresh.update(0.0, bench.ticks())
        assert len(bench.fresh.data) < 70_000
    assert bench.fresh.breaks == 2


@pytest.mark.parametrize("most", [4095, 16])
def test_wherever_a_process_stands_still_nothing_old_passes(most: int) -> None:
    """Stalls of all lengths come between any two calls; `turn` judges what is handed on."""
    passed = 0
    for seed in range(60):
        random = Random(seed)

        def stall_us(random: Random = random) -> int:
            return random.choice((3_000, 30_000, 60_000, 300_000)) if random.random() < 0.02 else random.randrange(100)

        bench = Bench(stall_us, most)
        passed += sum(len(bench.turn(random.randrange(1_000, 30_000))) for _ in range(150))
    assert passed > 20_000


def test_a_node_reads_a_port_until_it_is_empty_by_the_clock_that_goes_on_asleep(tmp_path: Path) -> None:
    moments = iter(range(1, 100))
    node: Any = SimpleNamespace(robot_ns=lambda: next(moments), monotonic=lambda: 1e9)
    port = FakePort(tmp_path / "device")
    link = Node.serial(node, str(port.link), 9600)
    first = link.poll(0.0)
    assert (first.opened, first.data, first.since_ns, first.until_ns) == (True, b"", 1, 3)
    for _ in range(16):
        port.say(b"x" * 1000)  # more than a read gives
    second = link.poll(0.1)
    assert (second.opened, len(second.data), second.since_ns, second.until_ns) == (False, 16_000, 2, 5)
    link.send(b"on\n")
    assert link.is_idle
    assert port.heard() == b"on\n"
    port.unplug()
    link.poll(0.2)
    assert "unplugged" in str(link.fault)
    port.close()
