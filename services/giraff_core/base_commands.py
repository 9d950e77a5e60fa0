"""Frames for the base board. Each answers a report and echoes its boot and time: the proof that it is fresh."""

from __future__ import annotations

from giraff_schemas.wire import PROTOCOL_HASH, ConfigureFrame, DriveFrame, EstopFrame, WheelsFrame, Wiring


class BaseCommands:
    """Numbers the frames of one host."""

    def __init__(self) -> None:
        self._seq = 0

    def configure(
        self, report: WheelsFrame, session: int, wiring: Wiring, level_max: int, stall_level: int
    ) -> ConfigureFrame:
        """Opens a session; levels are PWM counts of 255."""
        return ConfigureFrame(
            seq=self._next_seq(),
            protocol_hash=PROTOCOL_HASH,
            boot_id=report.boot_id,
            board_ms=report.board_ms,
            session=session,
            wiring=wiring,
            level_max=level_max,
            stall_level=stall_level,
        )

    def drive(self, report: WheelsFrame, left: int, right: int) -> DriveFrame:
        """Asks for levels: PWM counts of 255, forward positive."""
        return DriveFrame(
            seq=self._next_seq(),
            boot_id=report.boot_id,
            board_ms=report.board_ms,
            left_level=left,
            right_level=right,
        )

    def estop(self, report: WheelsFrame, session: int, *, engage: bool) -> EstopFrame:
        """Latches, or releases what is latched."""
        return EstopFrame(
            seq=self._next_seq(),
            boot_id=report.boot_id,
            board_ms=report.board_ms,
            session=session,
            engage=int(engage),
        )

    def _next_seq(self) -> int:
        self._seq = (self._seq + 1) & 0xFFFF
        return self._seq
