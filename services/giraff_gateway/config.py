"""The table `[gateway]` of the robot file."""

from typing import ClassVar

import msgspec

from giraff_core.tuning import Tuning
from giraff_schemas.topics import require_chunk


class GatewayConfig(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Where the board is, and how its lines are told apart."""

    LIVE: ClassVar = Tuning.READ_ONLY

    port: str = "/dev/ttyACM0"
    """Path of the board's serial port; one below /dev/serial/by-id names the same board wherever it is plugged in."""
    name: str = "arduino"
    """What it is called in keys: `serial/<name>`, `serial_write/<name>`."""
    baud: int = 9600
    """Bits per second, as in the board's `Serial.begin`."""
    longest_line: int = 4096
    """Bytes after which a line is cut into pieces, and beyond which no text is written."""
    ending: str = "\n"
    """Put after each text that is written."""

    def __post_init__(self) -> None:
        require_chunk(self.name)
        if not self.port:
            raise ValueError("port is empty: give the path of the board's serial port")
        if not 50 <= self.baud <= 4_000_000:
            raise ValueError(f"baud is {self.baud}: it must be in 50..4000000")
        if not 16 <= self.longest_line <= 65536:
            raise ValueError(f"longest_line is {self.longest_line}: it must be in 16..65536")
        if self.ending not in ("", "\n", "\r", "\r\n"):
            raise ValueError(f"ending is {self.ending!r}: it must be one of '', '\\n', '\\r' and '\\r\\n'")
