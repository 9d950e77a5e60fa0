"""A simulated board: the real ELF on a simavr core, or the same C for this machine."""

import shutil
import tempfile
from collections.abc import Callable
from enum import StrEnum
from functools import cache
from pathlib import Path
from typing import Any, Final

import cffi

from giraff_core.encoder_disk import Pattern
from giraff_schemas.boards import BoardType
from giraff_schemas.wire import ResetCause

ROOT: Final = Path(__file__).resolve().parents[2]
BUILD: Final = ROOT / "build"
_HEADER: Final = ROOT / "firmware" / "host" / "board_model.h"
_READ_BYTES: Final = 65536
_MESSAGE_BYTES: Final = 160

_ffi = cffi.FFI()


class BoardError(Exception):
    """A board that cannot be simulated. The message says why and, where there is one, the way out."""


class Implementation(StrEnum):
    """What runs a board's firmware."""

    AVR = "avr"
    """The ELF that is flashed, on simavr."""
    HOST = "host"
    """The same C, compiled for this machine."""


class RunState(StrEnum):
    """What a board's processor does."""

    RUNNING = "running"
    STOPPED = "stopped"
    """Asleep with interrupts off: only a reset wakes it."""
    CRASHED = "crashed"


_RUN_STATES: Final = (RunState.RUNNING, RunState.STOPPED, RunState.CRASHED)


def _declare() -> None:
    if not _HEADER.is_file():
        raise BoardError(f"{_HEADER} is missing: the simulator runs from the repository's tree")
    lines = _HEADER.read_text(encoding="utf-8").splitlines()
    _ffi.cdef("\n".join(line for line in lines if not line.startswith("#")))


class Board:
    """One board. `model` is its `struct board_model`: the world's side of the pins, as plain attributes."""

    def __init__(self, board: BoardType, library: Path, image: Path | None = None) -> None:
        """`library` implements board_model.h; `image` is the ELF, where it runs one."""
        if not library.is_file():
            raise BoardError(f"{library} is missing: run make")
        if image is not None and not image.is_file():
            raise BoardError(f"{image} is missing: run make -C firmware")
        for built in (library, image or library):
            if (source := newer_source(built)) is not None:
                raise BoardError(f"{built} was built before {source.resolve()} changed: run make setup")
        if "board_model" not in _declared_types():
            _declare()
        self.type = board
        self._library: Any = _open_privately(library)
        message = _ffi.new("char[]", _MESSAGE_BYTES)
        self.model: Any = self._library.board_open(str(image or "").encode(), board.name.encode(), message)
        if not self.model:
            text = _ffi.string(message)
            raise BoardError(text.decode(errors="replace") if isinstance(text, bytes) else text)
        self._buffer = _ffi.new("uint8_t[]", _READ_BYTES)
        self._ping: Any = None
        self._ping_error: BaseException | None = None
        self._disks: list[Any] = []  # what the library reads for as long as the board is open

    def set_disk(self, encoder: int, pattern: Pattern) -> None:
        """Let the encoder of that number read this disk in place of an ideal one."""
        states, edges = pattern
        at = _ffi.new("double[]", [edge.at * states for edge in edges])
        levels = _ffi.new("uint8_t[]", [edge.a | edge.b << 1 for edge in edges])
        disk = _ffi.new("struct encoder_disk *", {"edges": len(edges), "states": states, "at": at, "levels": levels})
        self._disks += [at, levels, disk]
        self.model.motor[encoder].disk = disk

    def on_ping(self, echo_us: Callable[[int], float]) -> None:
        """Ask `echo_us(sonar)` at each ping: the echo's length; 0 = none, negative = the line sticks high."""

        def ping(_user: object, sonar: int) -> float:
            return echo_us(sonar)

        def failed(_type: object, error: BaseException, _traceback: object) -> None:
            self._ping_error = error

        self._ping = _ffi.callback("double(void *, int)", ping, onerror=failed)
        self.model.on_ping = self._ping

    def run(self, until_us: int) -> None:
        """Run to the simulated instant `until_us`."""
        self._library.board_run(self.model, until_us)
        if self._ping_error is not None:
            error, self._ping_error = self._ping_error, None
            raise error

    def read(self) -> bytes:
        """The bytes the board has sent since the last call."""
        count = self._library.board_uart_read(self.model, self._buffer, _READ_BYTES)
        return bytes(_ffi.buffer(self._buffer, count))

    def write(self, data: bytes) -> int:
        """Hand bytes to the board's adapter, which sends them at the board's baud; how many it has taken."""
        return int(self._library.board_uart_write(self.model, data, len(data)))

    def reset(self, cause: ResetCause = ResetCause.EXTERNAL) -> None:
        """Reset the processor. A power-on also loses what RAM held; EEPROM is kept."""
        self._library.board_reset(self.model, int(cause))

    @property
    def registers(self) -> memoryview:
        """The 256 registers of the TWI slave."""
        return memoryview(_ffi.buffer(self.model.twi_register)).cast("B")

    @property
    def state(self) -> RunState:
        return _RUN_STATES[self.model.state]

    @property
    def message(self) -> str:
        """The simulator's last complaint about this board; empty when there is none."""
        text = _ffi.string(self.model.message)
        return text.decode(errors="replace").strip() if isinstance(text, bytes) else text

    @property
    def eeprom(self) -> bytes:
        """What the board keeps without power; empty when it keeps nothing."""
        cells = _ffi.new("uint8_t[]", self.type.eeprom_bytes)
        missing = self._library.board_eeprom(self.model, cells, len(cells), 0)
        return b"" if missing else bytes(_ffi.buffer(cells))

    def keep_from(self, cells: bytes) -> None:
        """Power the board on with what a board of its kind kept: the `eeprom` of an earlier one."""
        if self._library.board_eeprom(self.model, _ffi.new("uint8_t[]", cells), len(cells), 1):
            raise BoardError(f"these {len(cells)} bytes are not what a board of type {self.type.name} keeps")
        self.reset(ResetCause.POWER_ON)

    def close(self) -> None:
        """End the simulation of this board."""
        if self.model:
            self._library.board_close(self.model)
            self.model = _ffi.NULL
            _ffi.dlclose(self._library)


@cache
def newer_source(built: Path) -> Path | None:
    """Return a source that has changed since `built` was, by the record that its Makefile left beside it, if any."""
    record = built.with_suffix(".sources")
    if not record.is_file():
        return None  # a container has the library alone
    folder, _, rules = record.read_text(encoding="utf-8").partition("\n")
    sources = {record.parent / folder / word for word in rules.split() if word.endswith((".c", ".h", ".S"))}
    built_ns = built.stat().st_mtime_ns
    return next((each for each in sorted(sources) if each.is_file() and each.stat().st_mtime_ns > built_ns), None)


def _declared_types() -> list[str]:
    _typedefs, structs, _unions = _ffi.list_types()
    return structs


def _open_privately(library: Path) -> Any:
    """Load a copy of its own, because the host-compiled firmware keeps its state in globals."""
    with tempfile.NamedTemporaryFile(suffix=".so") as copy:
        shutil.copyfile(library, copy.name)
        try:
            return _ffi.dlopen(copy.name)
        except OSError as error:
            raise BoardError(f"{library} cannot be loaded: {error}; is libsimavr2 installed?") from error


def open_board(board: BoardType, implementation: Implementation, build: Path = BUILD) -> Board:
    """Open a board as it leaves the build: build/firmware, build/lockstep and build/host."""
    return Board(board, *(build / name for name in files_of(board, implementation)))


def files_of(board: BoardType, implementation: Implementation) -> tuple[str, ...]:
    """Return what a board is run from, below the build directory: the library, and where it runs one, the image."""
    if implementation is Implementation.HOST or board.is_process:
        return (f"host/{board.name}.so",)
    return "lockstep/lockstep.so", f"firmware/{board.name}.elf"
