"""The BNO055 of the joystick, as its registers show it; times and values are the datasheet's."""

import random
import struct
from enum import IntEnum, StrEnum
from typing import Final

from giraff_schemas.wire import TILT_LSB_PER_M_S2

ADDRESS: Final = 0x28
GRAVITY: Final = 9.80665  # m/s^2

CHIP_ID: Final = 0x00
ACC_ID: Final = 0x01
PAGE_ID: Final = 0x07
ACC_DATA: Final = 0x08
ST_RESULT: Final = 0x36
SYS_STATUS: Final = 0x39
SYS_ERR: Final = 0x3A
UNIT_SEL: Final = 0x3B
OPR_MODE: Final = 0x3D
SYS_TRIGGER: Final = 0x3F
AXIS_MAP_CONFIG: Final = 0x41
AXIS_MAP_SIGN: Final = 0x42

START_US: Final = 650_000  # from the end of a reset until it answers
FROM_CONFIG_US: Final = 7_000
TO_CONFIG_US: Final = 19_000
SAMPLE_US: Final = 8_000  # 62.5 Hz of bandwidth is 125 samples a second

_PAGE_SIZE: Final = 128
_RESET_SYSTEM: Final = 0x20  # of SYS_TRIGGER
_MODE_BITS: Final = 0x0F  # of OPR_MODE
_MILLI_G: Final = 0x01  # of UNIT_SEL
_FULL_RANGE: Final = 4 * GRAVITY
_IDENTITY: Final = {CHIP_ID: 0xA0, ACC_ID: 0xFB, 0x02: 0x32, 0x03: 0x0F, 0x04: 0x11, 0x05: 0x03, 0x06: 0x15}
_PAGE_0: Final = {ST_RESULT: 0x0F, UNIT_SEL: 0x80, OPR_MODE: 0x10, AXIS_MAP_CONFIG: 0x24}
_PAGE_1: Final = {0x08: 0x0D, 0x09: 0x6D, 0x0A: 0x38}
_FUSION_MODES: Final = range(0x08, 0x0D)

Vector = tuple[float, float, float]


class Bno055Fault(StrEnum):
    """What can be wrong with the sensor."""

    NONE = "none"
    DEAD = "dead"
    """Nothing answers on the bus."""
    ZERO = "zero"
    """Every acceleration reads 0, as on a bus that floats."""
    FROZEN = "frozen"
    """The acceleration no longer changes."""
    WRONG_CHIP = "wrong_chip"
    SELF_TEST = "self_test"
    """The power-on self-test of the accelerometer has failed."""
    SYSTEM_ERROR = "system_error"


class _Status(IntEnum):
    IDLE = 0
    ERROR = 1
    FUSION = 5
    NO_FUSION = 6


class Bno055:
    """The device behind the registers that the joystick's processor reads and writes."""

    def __init__(self, registers: memoryview, noise: float, seed: str, offset: Vector = (0.0, 0.0, 0.0)) -> None:
        """`noise`: m/s^2, standard deviation of each axis; `offset`: m/s^2 that each reads too much."""
        self.fault = Bno055Fault.NONE
        self._registers = registers
        self._noise = noise
        self._offset = offset
        self._random = random.Random(seed)
        self._answers_at = START_US
        self._other_page = bytearray(_PAGE_SIZE)
        self._page = 0
        self._mode = 0
        self._mode_at = 0  # us of simulated time from which _mode runs
        self._sampled_at = 0
        self._power_on_values()

    def step(self, now_us: int, reset_line: bool, acceleration: Vector) -> int:
        """Live to `now_us` with `acceleration` (m/s^2) acting. The bus address it answers at, 0 for none."""
        if reset_line or self._is_asked_to_reset(now_us):
            self._restart(now_us)
        if now_us < self._answers_at or self.fault is Bno055Fault.DEAD:
            return 0
        self._turn_page()
        if self._page == 0:
            self._follow_mode(now_us)
            self._show_faults()
            if now_us - self._sampled_at >= SAMPLE_US:
                self._sampled_at = now_us
                self._sample(now_us, acceleration)
        return ADDRESS

    def _is_asked_to_reset(self, now_us: int) -> bool:
        is_asked = self._page == 0 and bool(self._registers[SYS_TRIGGER] & _RESET_SYSTEM)
        return is_asked and now_us >= self._answers_at

    def _restart(self, now_us: int) -> None:
        self._answers_at = now_us + START_US
        self._power_on_values()
        self._mode = 0
        self._mode_at = now_us
        self._page = 0

    def _power_on_values(self) -> None:
        self._registers[:] = bytes(len(self._registers))
        self._other_page[:] = bytes(_PAGE_SIZE)
        self._other_page[PAGE_ID] = 1
        for register, value in (_IDENTITY | _PAGE_0).items():
            self._registers[register] = value
        for register, value in _PAGE_1.items():
            self._other_page[register] = value

    def _turn_page(self) -> None:
        wanted = self._registers[PAGE_ID] & 1
        if wanted == self._page:
            return
        shown = bytes(self._registers[:_PAGE_SIZE])
        self._registers[:_PAGE_SIZE] = bytes(self._other_page)
        self._other_page[:] = shown
        self._page = wanted
        self._registers[PAGE_ID] = wanted

    def _follow_mode(self, now_us: int) -> None:
        wanted = self._registers[OPR_MODE] & _MODE_BITS
        if wanted != self._mode:
            self._mode_at = now_us + (FROM_CONFIG_US if self._mode == 0 else TO_CONFIG_US)
            self._mode = wanted
        running = self._mode != 0 and now_us >= self._mode_at
        status = _Status.IDLE
        if running:
            status = _Status.FUSION if self._mode in _FUSION_MODES else _Status.NO_FUSION
        self._registers[SYS_STATUS] = status

    def _show_faults(self) -> None:
        is_wrong = self.fault is Bno055Fault.WRONG_CHIP
        self._registers[CHIP_ID] = 0x55 if is_wrong else _IDENTITY[CHIP_ID]
        self._registers[ST_RESULT] = 0x0E if self.fault is Bno055Fault.SELF_TEST else _PAGE_0[ST_RESULT]
        self._registers[SYS_ERR] = 0
        if self.fault is Bno055Fault.SYSTEM_ERROR:
            self._registers[SYS_STATUS] = _Status.ERROR
            self._registers[SYS_ERR] = 3  # system initialisation error

    def _sample(self, now_us: int, acceleration: Vector) -> None:
        if self._mode == 0 or now_us < self._mode_at or self.fault is Bno055Fault.FROZEN:
            return
        measured = (0.0, 0.0, 0.0) if self.fault is Bno055Fault.ZERO else self._mapped(acceleration)
        if self._noise and self.fault is not Bno055Fault.ZERO:
            measured = tuple(value + self._random.gauss(0.0, self._noise) for value in measured)
        unit = self._registers[UNIT_SEL] & _MILLI_G
        scale = 1000.0 / GRAVITY if unit else float(TILT_LSB_PER_M_S2)
        counts = (round(max(-_FULL_RANGE, min(_FULL_RANGE, value)) * scale) for value in measured)
        self._registers[ACC_DATA : ACC_DATA + 6] = struct.pack("<3h", *counts)

    def _mapped(self, acceleration: Vector) -> tuple[float, ...]:
        config, sign = self._registers[AXIS_MAP_CONFIG], self._registers[AXIS_MAP_SIGN]
        mapped = []
        for axis in range(3):
            source = config >> (2 * axis) & 3
            value = acceleration[source] + self._offset[source] if source < 3 else 0.0
            mapped.append(-value if sign & (4 >> axis) else value)
        return tuple(mapped)
