"""The joystick board on its port, read in place of the joystick service: no tilt can drive a robot meanwhile."""

from __future__ import annotations

import select
import time
from collections.abc import Iterator
from typing import Final

from giraff_core.tilt.clutch import Vector
from giraff_joystick.policy import reading, trouble_of
from giraff_node.boards.board_link import BoardLink
from giraff_schemas.boards import JOYSTICK_BOARD
from giraff_schemas.wire import TiltFrame

_SILENCE: Final = 4.0
"""s without a reading. An adapter that resets its board costs half of it, with the start of the sensor."""
_WAIT: Final = 0.05  # s


class BoardError(Exception):
    """The board gives no readings. One line: what is wrong, and what to do."""


class TiltBoard:
    """Owns the port. Raises BoardError where the board falls silent, starts again, or its sensor fails."""

    def __init__(self, port: str) -> None:
        self._port = port
        self._link = BoardLink(port, JOYSTICK_BOARD)
        self._boot: int | None = None
        self._heard = time.monotonic()
        self._starting = ""

    def poll(self) -> list[Vector]:
        """Return the sensor's readings that have arrived, m/s² in its own axes."""
        frames = [frame for frame in self._link.poll(time.monotonic()) if isinstance(frame, TiltFrame)]
        readings = [vector for frame in frames if (vector := self._reading(frame)) is not None]
        if readings:
            self._heard = time.monotonic()
        elif time.monotonic() - self._heard > _SILENCE:
            hint = "; giraff_joystick must not run meanwhile" if self._boot is None else ""
            raise BoardError(self._starting or f"{self._link.fault}{hint}")
        return readings

    def readings(self) -> Iterator[Vector]:
        """Yield reading after reading from now on; what has arrived before is dropped."""
        self.poll()
        while True:
            yield from (arrived := self.poll())
            if not arrived:
                descriptor = self._link.descriptor()
                select.select([] if descriptor is None else [descriptor], [], [], _WAIT)

    def close(self) -> None:
        """Let go of the port."""
        self._link.close()

    def _reading(self, frame: TiltFrame) -> Vector | None:
        if self._boot not in {None, frame.boot_id}:
            raise BoardError(f"{self._port}: the board was reset in between; check its cable, and begin again")
        self._boot = frame.boot_id
        tilt = reading(frame)
        if tilt.status == "running":
            return tilt.x, tilt.y, tilt.z
        self._starting = f"{self._port}: {trouble_of(tilt.status, frame)}"
        if tilt.status != "starting":
            raise BoardError(self._starting)
        return None
