"""Frames for the base board. Each answers a report and echoes its boot and time: the proof that it is fresh."""

import msgspec

from giraff_schemas.wire import ConfigureFrame, DriveFrame, EstopFrame, SpeedFrame, WheelsFrame


class WheelsCommands:
    """Numbers the frames of one host."""

    def __init__(self) -> None:
        self._seq = 0

    def configure(self, report: WheelsFrame, session: int, settings: ConfigureFrame) -> ConfigureFrame:
        """Opens a session with such settings, whatever frame they were made for."""
        return msgspec.structs.replace(
            settings, seq=self._next_seq(), boot_id=report.boot_id, board_ms=report.board_ms, session=session
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

    def speed(self, report: WheelsFrame, left: int, right: int) -> SpeedFrame:
        """Asks for speeds: µm/s, forward positive."""
        return SpeedFrame(
            seq=self._next_seq(),
            boot_id=report.boot_id,
            board_ms=report.board_ms,
            left_um_s=left,
            right_um_s=right,
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
