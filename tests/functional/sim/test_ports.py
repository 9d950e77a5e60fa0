"""The serial ports: what a program that opens one sees."""

import errno
import os
import select
import termios
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import pytest

from giraff_schemas.framing import Decoder, encode
from giraff_schemas.wire import BoardKind, HelloFrame, HelloRequestFrame, RangeFrame
from giraff_sim.board import Implementation
from giraff_sim.hosts.cable import BoardUart
from giraff_sim.ptys import SerialPort
from giraff_sim.simulation import Simulation, simulation
from tests.sim.robots import room_with_wall, world_in
from tests.support.serial_device import BYTE_US, CountingDevice
from tests.support.waiting import wait


@pytest.fixture
def ranger(implementation: Implementation) -> Iterator[Simulation]:
    """A ranger board."""
    with simulation(world_in(room_with_wall(2.0)), (BoardKind.RANGER,), implementation) as running:
        yield running


@pytest.fixture
def port(ranger: Simulation, tmp_path: Path) -> Iterator[SerialPort]:
    """Its port, plugged in."""
    port = SerialPort(BoardUart(BoardKind.RANGER, ranger), tmp_path / "ports" / "ranger")
    port.plug()
    yield port
    port.unplug()


def carry(simulation: Simulation, port: SerialPort, seconds: float, *, pause: float = 0.0) -> None:
    """Run, with a pause (s of the wall's time) in each millisecond for the kernel to move bytes on."""
    for _ in range(round(seconds * 1000)):
        simulation.step()
        port.carry(simulation.now_us)
        if pause:
            time.sleep(pause)


def opened(path: Path) -> int:
    return os.open(path, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)


def arrived(host: int) -> bytes:
    """All that was sent: what the kernel still moves on is waited for."""
    poll = select.poll()
    poll.register(host, select.POLLIN)
    data = b""
    while poll.poll(100):
        data += os.read(host, 65536)
    return data


def is_hung_up(host: int) -> bool:
    """Whether reading ends in the error, or the end of file, of a terminal whose other end has gone."""
    try:
        while os.read(host, 65536):
            pass
    except OSError as error:
        return error.errno == errno.EIO
    return True


def test_frames_pass_both_ways_unchanged(ranger: Simulation, port: SerialPort) -> None:
    assert port.path.is_symlink()
    host = opened(port.path)
    decoder = Decoder()
    try:
        carry(ranger, port, 0.5)
        frames = decoder.feed(arrived(host))
        assert sum(isinstance(frame, HelloFrame) for frame in frames) == 1
        assert sum(isinstance(frame, RangeFrame) for frame in frames) > 4
        os.write(host, encode(HelloRequestFrame(seq=10).pack()))  # 10 and 13 are line ends to a cooked terminal
        os.write(host, encode(HelloRequestFrame(seq=13).pack()))
        carry(ranger, port, 0.1)
        frames = decoder.feed(arrived(host))
        assert sum(isinstance(frame, HelloFrame) for frame in frames) == 2
        assert decoder.crc_errors == decoder.shape_errors == 0
    finally:
        os.close(host)


def test_a_reader_may_come_and_go(ranger: Simulation, port: SerialPort) -> None:
    for _ in range(3):
        host = opened(port.path)
        termios.tcflush(host, termios.TCIOFLUSH)
        carry(ranger, port, 0.3)
        assert len(arrived(host)) > 100
        os.close(host)


def test_unplugged_the_path_is_gone_and_a_reader_sees_an_error(ranger: Simulation, port: SerialPort) -> None:
    host = opened(port.path)
    carry(ranger, port, 0.2)
    port.unplug()
    port.unplug()
    assert not port.path.is_symlink()
    assert not port.is_plugged
    poll = select.poll()
    poll.register(host, select.POLLIN)
    assert poll.poll(0)
    assert is_hung_up(host)
    os.close(host)
    lost = port.lost
    carry(ranger, port, 0.2)
    assert port.lost > lost
    port.plug()
    port.plug()
    host = opened(port.path)
    carry(ranger, port, 0.2)
    assert arrived(host)
    os.close(host)


def test_a_port_that_nobody_reads_loses_bytes_and_nothing_else(ranger: Simulation, port: SerialPort) -> None:
    carry(ranger, port, 40.0)
    assert port.lost > 0
    board = ranger.boards[BoardKind.RANGER].model
    assert board.tx_lost == 0
    host = opened(port.path)
    termios.tcflush(host, termios.TCIOFLUSH)
    carry(ranger, port, 0.5)
    decoder = Decoder()
    assert len(decoder.feed(arrived(host))) >= 7
    os.close(host)


def test_bytes_that_pile_up_wait_in_the_kernel_and_pass(ranger: Simulation, port: SerialPort) -> None:
    carry(ranger, port, 0.1)
    host = opened(port.path)
    waiting = encode(HelloRequestFrame(seq=1).pack())
    written = 0
    with suppress(BlockingIOError):
        while True:
            written += os.write(host, waiting)
    assert written > 10_000
    taken = ranger.boards[BoardKind.RANGER].model.rx_total
    carry(ranger, port, 0.1, pause=0.001)
    passed = ranger.boards[BoardKind.RANGER].model.rx_total - taken
    assert 0 < passed < 1.06 * 0.1 * 50_000  # 500 000 baud, as tests/sim/test_board.py judges; the kernel may be slower

    def all_passed() -> bool:
        carry(ranger, port, 0.1, pause=0.0005)
        return bool(ranger.boards[BoardKind.RANGER].model.rx_total - taken == written)

    wait(all_passed, 60.0)
    os.close(host)


def test_a_stale_path_is_replaced_by_the_port_of_any_device(tmp_path: Path) -> None:
    path, device = tmp_path / "scan", CountingDevice()
    path.symlink_to("/nowhere")
    port = SerialPort(device, path)
    port.plug()
    assert path.resolve().is_char_device()
    host = opened(path)
    port.carry(10 * BYTE_US)
    assert arrived(host) == CountingDevice().bytes_until(10 * BYTE_US)
    os.write(host, b"hello")
    while not device.received:
        port.carry(10 * BYTE_US)
    assert device.received == b"hello"
    os.close(host)
    port.unplug()
