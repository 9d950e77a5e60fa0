"""A host-compiled board, behind firmware/host/board_model.h."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

import cffi

from giraff_schemas.wire import BoardKind, ResetCause

ROOT: Final = Path(__file__).resolve().parents[2]
FIRMWARE: Final = ROOT / "firmware"

_BUFFER_BYTES: Final = 65536
_MESSAGE_BYTES: Final = 160


def _declared() -> cffi.FFI:
    ffi = cffi.FFI()
    lines = (FIRMWARE / "host" / "board_model.h").read_text().splitlines()
    ffi.cdef("\n".join(line for line in lines if not line.startswith("#")))
    return ffi


_ffi = _declared()


def _open(library: str) -> Any:
    return _ffi.dlopen(library)


class Board:
    """A board of `kind` that was powered on at 0 us. `model` is its struct board_model."""

    def __init__(self, kind: BoardKind, library: Path) -> None:
        with tempfile.NamedTemporaryFile(suffix=".so") as copy:  # a loaded library holds one board only
            shutil.copyfile(library, copy.name)
            self._library = _open(copy.name)
        message = _ffi.new("char[]", _MESSAGE_BYTES)
        self.model: Any = self._library.board_open(_ffi.NULL, int(kind), message)
        if not self.model:
            raise ValueError(str(_ffi.string(message)))
        self._buffer = _ffi.new("uint8_t[]", _BUFFER_BYTES)
        self._on_ping: Any = None

    def on_ping(self, echo_us: Callable[[int], float]) -> None:
        """Ask echo_us(sonar) at each ping."""
        self._on_ping = _ffi.callback("double(void *, int)", lambda _user, sonar: echo_us(sonar))
        self.model.on_ping = self._on_ping

    def run(self, until_us: int) -> None:
        self._library.board_run(self.model, until_us)

    def read(self) -> bytes:
        count = self._library.board_uart_read(self.model, self._buffer, _BUFFER_BYTES)
        return bytes(_ffi.buffer(self._buffer, count))

    def write(self, data: bytes) -> int:
        """How many of the bytes the line has taken."""
        return int(self._library.board_uart_write(self.model, data, len(data)))

    def reset(self, cause: ResetCause = ResetCause.EXTERNAL) -> None:
        self._library.board_reset(self.model, int(cause))

    @property
    def registers(self) -> memoryview:
        """The 256 registers of the slave on the two-wire bus."""
        return memoryview(_ffi.buffer(self.model.twi_register)).cast("B")

    def read_eeprom(self, size: int) -> bytes:
        cells = _ffi.new("uint8_t[]", size)
        assert self._library.board_eeprom(self.model, cells, size, 0) == 0
        return bytes(_ffi.buffer(cells))

    def write_eeprom(self, cells: bytes) -> None:
        assert self._library.board_eeprom(self.model, _ffi.new("uint8_t[]", cells), len(cells), 1) == 0

    @property
    def message(self) -> str:
        """The bench's last complaint about what the board did to its parts."""
        text = _ffi.string(self.model.message)
        assert isinstance(text, bytes)
        return text.decode()

    def close(self) -> None:
        self._library.board_close(self.model)
        _ffi.dlclose(self._library)
