"""A slave on the joystick's bus: a BNO055 that can fail in each way the board must notice."""

import struct

from giraff_schemas.wire import TILT_LSB_PER_M_S2
from tests.firmware.bench import Bench

ADDRESS = 0x28
START_MS = 650  # from the end of a reset, as the datasheet has it

CHIP_ID, ACC_ID, ACC_DATA, ST_RESULT = 0x00, 0x01, 0x08, 0x36
SYS_STATUS, SYS_ERR, UNIT_SEL, OPR_MODE = 0x39, 0x3A, 0x3B, 0x3D

CONFIG, ACCONLY = 0, 1
POWER_ON_UNIT, POWER_ON_MODE = 0x81, 0x1C  # values no driver writes, so that its writes show


class Bno055:
    """Lives in simulated ms; keeps what was done to it."""

    def __init__(self, bench: Bench) -> None:
        self.start_ms = START_MS
        self.answers = True
        self.chip_id, self.acc_id, self.st_result = 0xA0, 0xFB, 0x0F
        self.error = 0
        self.vector = (1.0, -2.0, 9.5)
        self.resets_ms: list[tuple[int, int]] = []
        """When the reset line fell and rose."""
        self.modes: list[tuple[int, int]] = []
        """When which operating mode was written."""
        self._bench = bench
        self._registers = bench.board.registers
        self._reset_since: int | None = None
        self._awake_at = START_MS
        self._power_on()
        bench.before_each_ms = self.step

    def _power_on(self) -> None:
        self._registers[UNIT_SEL] = POWER_ON_UNIT
        self._registers[OPR_MODE] = POWER_ON_MODE
        self._mode = POWER_ON_MODE
        self._mode_at = 0

    def step(self) -> None:
        now, model, registers = self._bench.now_ms, self._bench.model, self._registers
        if model.slave_reset:
            if self._reset_since is None:
                self._reset_since = now
            self._power_on()
        elif self._reset_since is not None:
            self.resets_ms.append((self._reset_since, now))
            self._reset_since = None
            self._awake_at = now + self.start_ms
        awake = not model.slave_reset and now >= self._awake_at
        model.twi_address = ADDRESS if awake and self.answers else 0
        if registers[OPR_MODE] != self._mode:
            self._mode, self._mode_at = registers[OPR_MODE], now
            self.modes.append((now, self._mode))
        self._show(self._mode == ACCONLY and now - self._mode_at >= 7)

    def _show(self, runs: bool) -> None:
        registers = self._registers
        registers[CHIP_ID], registers[ACC_ID], registers[ST_RESULT] = self.chip_id, self.acc_id, self.st_result
        registers[SYS_ERR] = self.error
        registers[SYS_STATUS] = 1 if self.error else 6 if runs else 0
        counts = (round(value * TILT_LSB_PER_M_S2) if runs else 0 for value in self.vector)
        registers[ACC_DATA : ACC_DATA + 6] = struct.pack("<3h", *counts)
