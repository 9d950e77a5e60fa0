"""The BNO055's registers, as the datasheet has them."""

import struct
from itertools import pairwise

import pytest

from giraff_sim.world import bno055
from giraff_sim.world.bno055 import ADDRESS, Bno055, Bno055Fault, Vector

MS = 1000
FLAT: Vector = (0.0, 0.0, 9.80665)


class Device:
    """A sensor with its registers, lived a millisecond at a time."""

    def __init__(self, noise: float = 0.0, offset: Vector = (0.0, 0.0, 0.0)) -> None:
        self.registers = bytearray(256)
        self.sensor = Bno055(memoryview(self.registers), noise, "seed", offset)
        self.now_us = 0
        self.address = 0

    def live(self, milliseconds: int, acceleration: Vector = FLAT, *, reset_line: bool = False) -> None:
        for _ in range(milliseconds):
            self.now_us += MS
            self.address = self.sensor.step(self.now_us, reset_line, acceleration)

    def acceleration(self) -> tuple[int, ...]:
        return struct.unpack("<3h", self.registers[8:14])


@pytest.fixture
def running() -> Device:
    device = Device()
    device.live(650)
    device.registers[bno055.OPR_MODE] = 1
    device.live(20)
    return device


def test_it_answers_650_ms_after_the_reset_line_is_let_go() -> None:
    device = Device()
    device.live(300, reset_line=True)
    assert device.address == 0
    device.live(649)
    assert device.address == 0
    device.live(1)
    assert device.address == ADDRESS
    assert device.registers[bno055.CHIP_ID] == 0xA0
    assert device.registers[bno055.ACC_ID] == 0xFB
    assert device.registers[bno055.ST_RESULT] == 0x0F
    assert device.registers[bno055.SYS_STATUS] == 0
    assert device.registers[bno055.OPR_MODE] & 0x0F == 0


def test_it_runs_7_ms_after_leaving_the_configuration_mode() -> None:
    device = Device()
    device.live(700)
    assert device.acceleration() == (0, 0, 0)
    device.registers[bno055.OPR_MODE] = 1
    device.live(7)
    assert device.registers[bno055.SYS_STATUS] == 0
    device.live(1)
    assert device.registers[bno055.SYS_STATUS] == 6
    device.live(8)
    assert device.acceleration() == (0, 0, 981)
    device.registers[bno055.OPR_MODE] = 0x0C
    device.live(20)
    assert device.registers[bno055.SYS_STATUS] == 5


def test_acceleration_is_100_a_metre_per_second_squared_within_4_g(running: Device) -> None:
    running.live(8, (4.5, -9.5, 0.014))
    assert running.acceleration() == (450, -950, 1)
    running.live(8, (99.0, -99.0, 0.0))
    assert running.acceleration() == (3923, -3923, 0)
    running.registers[bno055.UNIT_SEL] = 0x81
    running.live(8, FLAT)
    assert running.acceleration() == (0, 0, 1000)


def test_axes_can_be_mapped(running: Device) -> None:
    running.registers[bno055.AXIS_MAP_CONFIG] = 0x21  # x and y change places
    running.registers[bno055.AXIS_MAP_SIGN] = 0x04  # and x its sign
    running.live(8, (1.0, 2.0, 3.0))
    assert running.acceleration() == (-200, 100, 300)


def test_a_new_sample_comes_every_8_ms(running: Device) -> None:
    seen = []
    for millisecond in range(80):
        running.live(1, (millisecond / 10, 0.0, 0.0))
        seen.append(running.acceleration()[0] / 10)
    changes = [now for before, now in pairwise(seen) if now != before]
    assert [later - earlier for earlier, later in pairwise(changes)] == [8.0] * (len(changes) - 1)


def test_a_reset_by_register_or_by_line_starts_anew(running: Device) -> None:
    running.registers[bno055.SYS_TRIGGER] = 0x20
    running.live(1)
    assert running.address == 0
    running.live(650)
    assert running.address == ADDRESS
    assert running.registers[bno055.OPR_MODE] & 0x0F == 0
    assert running.registers[bno055.SYS_TRIGGER] == 0
    running.live(1, reset_line=True)
    assert running.address == 0


def test_the_second_page_is_another_window(running: Device) -> None:
    running.registers[bno055.PAGE_ID] = 1
    running.live(1)
    assert running.registers[8] == 0x0D  # ACC_Config
    running.registers[8] = 0x0E
    running.registers[bno055.PAGE_ID] = 0
    running.live(9)
    assert running.registers[bno055.CHIP_ID] == 0xA0
    assert running.acceleration() == (0, 0, 981)
    running.registers[bno055.PAGE_ID] = 1
    running.live(1)
    assert running.registers[8] == 0x0E


def test_faults_and_their_mending(running: Device) -> None:
    sensor = running.sensor
    sensor.fault = Bno055Fault.DEAD
    running.live(1)
    assert running.address == 0
    sensor.fault = Bno055Fault.ZERO
    running.live(8)
    assert running.address == ADDRESS
    assert running.acceleration() == (0, 0, 0)
    sensor.fault = Bno055Fault.NONE
    running.live(8, (1.0, 0.0, 9.0))
    sensor.fault = Bno055Fault.FROZEN
    running.live(100, FLAT)
    assert running.acceleration() == (100, 0, 900)
    sensor.fault = Bno055Fault.WRONG_CHIP
    running.live(1)
    assert running.registers[bno055.CHIP_ID] != 0xA0
    sensor.fault = Bno055Fault.SELF_TEST
    running.live(1)
    assert running.registers[bno055.CHIP_ID] == 0xA0
    assert running.registers[bno055.ST_RESULT] & 1 == 0
    sensor.fault = Bno055Fault.SYSTEM_ERROR
    running.live(1)
    assert running.registers[bno055.SYS_STATUS] == 1
    assert running.registers[bno055.SYS_ERR] != 0
    sensor.fault = Bno055Fault.NONE
    running.live(8)
    assert running.registers[bno055.SYS_STATUS] == 6
    assert running.registers[bno055.SYS_ERR] == 0
    assert running.acceleration() == (0, 0, 981)


def test_noise_is_what_was_asked_for() -> None:
    device = Device(noise=0.05)
    device.live(650)
    device.registers[bno055.OPR_MODE] = 1
    device.live(20)
    readings = []
    for _ in range(500):
        device.live(8)
        readings.append(device.acceleration()[0])
    mean = sum(readings) / len(readings)
    assert abs(mean) < 1.0
    assert (sum((value - mean) ** 2 for value in readings) / len(readings)) ** 0.5 == pytest.approx(5.0, rel=0.15)


def test_an_offset_is_the_sensors_own_and_turns_with_its_axes() -> None:
    device = Device(offset=(0.3, -0.2, 0.1))
    device.live(650)
    device.registers[bno055.OPR_MODE] = 1
    device.live(30, (1.0, 2.0, 9.0))
    assert device.acceleration() == (130, 180, 910)
    device.registers[bno055.AXIS_MAP_CONFIG] = 0x21  # x and y change places
    device.live(20, (1.0, 2.0, 9.0))
    assert device.acceleration() == (180, 130, 910)
    device.sensor.fault = Bno055Fault.ZERO
    device.live(20, (1.0, 2.0, 9.0))
    assert device.acceleration() == (0, 0, 0)
