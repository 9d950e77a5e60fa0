"""The balancing robot's board on the bench: it is upright and still, and its wheels do not turn by themselves."""

import math
import random
from typing import Final

import msgspec

from giraff_schemas.wires.balancer import (
    BalanceAsk,
    BalanceConfigureFrame,
    BalanceDriveFrame,
    BalanceEngage,
    BalanceEstopFrame,
    BalanceFlag,
    BalanceFrame,
    BalancePosture,
)
from giraff_sim.board import Board
from tests.firmware.bench import Bench
from tests.support.balancer_file import DRIVE, ROBOT

AREF: Final = 3.3
COUNTS: Final = 1024
GYRO_ZERO: Final = 471.0
ACCELEROMETER_ZERO: Final = 512.0
COUNTS_PER_G: Final = 102.0
GYRO_DEGREES: Final = 1.611
"""deg/s for each count."""
NOISE: Final = 0.35
"""Counts: a sensor without noise is broken."""
MOST_RATE: Final = 1e-4
"""rad in a millisecond, at which a person leans it."""
# A divider by which neither a full nor a low battery is what faults/hung_loop.c waits for.
SETTINGS: Final = msgspec.structs.replace(DRIVE.board_settings(ROBOT), session=7, battery_uv_count=25_000)
"""Those of the robot file."""


class BalancerBench(Bench):
    """A board whose robot a person holds upright, and a host that knows how to drive it."""

    def __init__(self, board: Board) -> None:
        super().__init__(board)
        self.seq = 0
        self.lean = 0.0
        """rad. To where a person leans it."""
        self._lean_now = 0.0
        self.battery = 12.4
        self._noise = random.Random(1)
        self.model.driver_volts = self.battery
        self.before_each_ms = self._feel
        self.run(20)

    def _feel(self) -> None:
        step = max(-MOST_RATE, min(self.lean - self._lean_now, MOST_RATE))
        self._lean_now += step
        turns = GYRO_ZERO + math.degrees(1000 * step) * math.sqrt(0.5) / GYRO_DEGREES
        gravity = (-math.sin(self._lean_now), math.cos(self._lean_now))
        for sensor, counts in enumerate(
            (turns, turns, *(ACCELEROMETER_ZERO + COUNTS_PER_G * part for part in gravity))
        ):
            self.model.sensor_volts[sensor] = (counts + 0.5 + self._noise.gauss(0, NOISE)) * AREF / COUNTS
        self.model.battery_volts = (self.battery / SETTINGS.battery_uv_count * 1e6 + 0.5) * AREF / COUNTS

    def report(self) -> BalanceFrame:
        return self.last(BalanceFrame)

    def duties(self) -> tuple[float, float]:
        """What the driver gives each motor, of 255."""
        left, right = self.model.motor
        return left.drive, right.drive

    def configure_frame(self, **changes: int) -> BalanceConfigureFrame:
        report = self.report()
        good = msgspec.structs.replace(SETTINGS, boot_id=report.boot_id, board_ms=report.board_ms)
        return msgspec.structs.replace(good, **changes)

    def drive_frame(self, linear: float = 0.0, **changes: int) -> BalanceDriveFrame:
        """The next frame of a healthy host, made from the newest telemetry, but for `changes`; m/s."""
        self.seq = (self.seq + 1) & 0xFFFF
        report = self.report()
        good = BalanceDriveFrame(
            seq=self.seq,
            boot_id=report.boot_id,
            board_ms=report.board_ms,
            linear_um_s=round(linear * 1e6),
            angular_urad_s=0,
            ask=BalanceAsk.KEEP,
            free_side=0,
        )
        return msgspec.structs.replace(good, **changes)

    def estop_frame(self, engage: int, **changes: int) -> BalanceEstopFrame:
        report = self.report()
        good = BalanceEstopFrame(
            seq=0, boot_id=report.boot_id, board_ms=report.board_ms, session=report.session, engage=engage
        )
        return msgspec.structs.replace(good, **changes)

    def configure(self, **changes: int) -> None:
        """Open a session and wait until telemetry tells of it."""
        self.send(self.configure_frame(**changes))
        self.run(25)

    def drive(self, linear: float = 0.0, milliseconds: int = 20, **changes: int) -> None:
        """Ask every 20 ms."""
        for _ in range(milliseconds // 20):
            self.send(self.drive_frame(linear, **changes))
            self.run(20)

    def estop(self, engage: BalanceEngage, **changes: int) -> None:
        self.send(self.estop_frame(engage, **changes))
        self.run(25)

    def stand(self) -> None:
        """From power-on to standing."""
        self.configure()
        self.get_up()

    def get_up(self) -> None:
        """From off to standing, in the hands of a person."""
        for _ in range(500):
            self.drive()
            if self.report().flags & BalanceFlag.UPRIGHT:
                break
        self.drive(milliseconds=60, ask=BalanceAsk.STAND)
        assert self.report().posture == BalancePosture.STANDS
