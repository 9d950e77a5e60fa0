"""Devices without our firmware in simulated time: what a sense is given of one's bytes, and a gateway's lines."""

from collections.abc import Callable
from typing import Any

from giraff_core.fresh_bytes import FreshBytes
from giraff_core.io import IO
from giraff_core.timer import Timer
from giraff_gateway.config import GatewayConfig
from giraff_gateway.service import Gateway
from giraff_schemas.messages import RobotTime, SerialLine, SerialWrite
from giraff_schemas.topics import SERIAL_WRITE, TICK
from giraff_sim.closed_loop import ClosedLoop
from giraff_sim.hosts.cable import Cable
from giraff_sim.hosts.process import Observer, Process
from tests.loop.loops import SETTINGS, closed_loop
from tests.sim.robots import empty_room
from tests.support.serial_device import PACKET_US, CountingDevice, packets

FAULT_S = 0.3


class Sense:
    """Reads the device that counts, and keeps what it is given."""

    link = None

    def __init__(self, io: IO) -> None:
        self._io = io
        self.timers = (Timer(50.0),)
        self.fresh = FreshBytes(io.serial("device", 40_000), io.robot_ns, delay=0.002)
        self._ticks = io.inbox(TICK, wakes=False)
        self.found: list[tuple[int, RobotTime | None, int]] = []
        """When the first byte left, in us; the tick; when it was handed on, in ns of the robot's clock."""

    def turn(self, now: float) -> None:
        self.timers[0].due(now)
        self.fresh.update(now, self._ticks.pop_all())
        self.found += [(*each, self._io.robot_ns()) for each in packets(self.fresh)]

    def end(self) -> None:
        """Nothing is left to say."""


def stop(loop: ClosedLoop) -> None:
    process = loop.processes["sense"]
    process.paused = True
    loop.run(FAULT_S)
    process.paused = False
    process.go_on()


def suspend(loop: ClosedLoop) -> None:
    host, cable = loop.hosts["robot"], loop.cables["device"]
    host.suspend()
    cable.holds_to_host = True  # the adapter's buffer fills, and comes after the wake
    loop.run(FAULT_S)
    host.resume()
    cable.holds_to_host = False
    for process in loop.processes.values():
        process.go_on()


def unplug(loop: ClosedLoop) -> None:
    loop.cables["device"].unplug()
    loop.run(FAULT_S)
    loop.cables["device"].plug()


def test_nothing_from_before_a_stall_is_handed_on_after_it() -> None:
    with closed_loop(empty_room()) as loop:
        loop.cables["device"] = Cable(CountingDevice(), loop.simulation)
        made: list[Sense] = []

        def make(io: IO) -> Sense:
            made.append(Sense(io))
            return made[-1]

        loop.launch("sense", make, loop.hosts["robot"])
        [sense] = made
        booted_ns = loop.robot_ns - loop.simulation.now_us * 1000
        loop.run(0.5)
        faults: tuple[Callable[[ClosedLoop], None], ...] = (stop, suspend, unplug)
        for number, fault in enumerate(faults, start=2):
            begun_us, before = loop.simulation.now_us, len(sense.found)
            assert before > 100
            fault(loop)
            ended_us = loop.simulation.now_us
            loop.run(0.5)
            after = [us for us, _, _ in sense.found[before:]]
            assert sense.fresh.breaks == number, fault
            assert not [us for us in after if begun_us <= us <= ended_us], fault
            assert len(after) * PACKET_US > 300_000, fault
        for us, tick, now_ns in sense.found:
            assert tick is not None
            assert tick.robot_ns <= booted_ns + us * 1000
            assert now_ns - booted_ns - (us + PACKET_US) * 1000 <= 50_000_000


class Talker:
    """An Arduino that prints what it is told to."""

    def __init__(self) -> None:
        self.says = b""
        self.received = b""

    def bytes_until(self, now_us: int) -> bytes:
        del now_us
        said, self.says = self.says, b""
        return said

    def receive(self, data: bytes) -> int:
        self.received += data
        return len(data)


class Heard(Observer):
    """Keeps the lines that are published."""

    def __init__(self) -> None:
        self.lines: list[str] = []

    def said(self, process: Process, sample: Any) -> None:
        del process
        if isinstance(sample, SerialLine):
            self.lines.append(sample.text)


def test_a_gateway_passes_lines_both_ways_and_loses_none_while_it_stands() -> None:
    heard = Heard()
    lines = heard.lines
    with closed_loop(empty_room(), observer=heard) as loop:
        arduino = Talker()
        cable = loop.cables["arduino"] = Cable(arduino, loop.simulation)
        config = GatewayConfig(port="arduino", name="weather")
        gateway = loop.launch("gateway", lambda io: Gateway(io, config, SETTINGS.robot), loop.hosts["robot"])
        loop.run(0.1)
        for text in (b"23.", b"5\nha"):
            arduino.says = text
            loop.run(0.05)
        assert lines == ["23.5"]
        gateway.paused = True
        arduino.says = b"lf\nwaited\nbe"
        loop.run(0.2)
        gateway.paused = False
        gateway.go_on()
        loop.processes["base"].say(SERIAL_WRITE.at("weather").key, SerialWrite(name="weather", text="led"))
        loop.run(0.1)
        assert lines == ["23.5", "half", "waited"]
        assert arduino.received == b"led\n"
        cable.unplug()
        loop.run(0.2)
        assert "no such port" in gateway.told["port"]
        loop.processes["base"].say(SERIAL_WRITE.at("weather").key, SerialWrite(name="weather", text="to nobody"))
        loop.run(0.1)
        assert "texts were not written" in gateway.told["write"]
        cable.plug()
        loop.run(0.2)
        arduino.says = b"anew\n"
        loop.run(0.1)
        assert lines[3:] == ["anew"], "what was begun before is another life's"
        assert arduino.received == b"led\n"
