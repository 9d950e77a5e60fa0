"""The simulated camera, at its Unix socket."""

import io
import socket
import time
from typing import Final

import msgspec
import numpy as np

from giraff_camera.device.image import DeviceError, Image
from giraff_camera.device.raw_frames import Header, Wanted
from giraff_schemas.text import plain
from giraff_schemas.trouble import Trouble

_LONGEST_HEADER: Final = 512
"""bytes."""
_S_PER_NS: Final = 1e-9


class SimulatedCamera:
    """A connection to it. It ends with the first thing that is not as `raw_frames` has it."""

    def __init__(self, path: str, width: int, height: int, rate: float) -> None:
        """Connect, and ask for pictures. Raises DeviceError."""
        self._path, self._shape = path, (height, width)
        self._socket = socket.socket(socket.AF_UNIX)
        try:
            self._socket.connect(path)
            self._socket.sendall(msgspec.json.encode(Wanted(width=width, height=height, rate=rate)) + b"\n")
        except OSError as error:
            self._socket.close()
            raise DeviceError(self._gone(error.strerror or str(error))) from error
        # A buffer that holds a header at most: pixels go past it.
        self._file = io.BufferedReader(self._socket.makefile("rb", buffering=0), _LONGEST_HEADER)

    def read(self) -> Image:
        """Wait for the next picture. Raises DeviceError."""
        try:
            line = self._file.readline(_LONGEST_HEADER)
            if not line:
                raise DeviceError(self._gone("it has ended"))
            header = msgspec.json.decode(line, type=Header)
            # The memory is of the size that was asked for, whatever the header says.
            if (header.height, header.width) != self._shape:
                raise DeviceError(self._wrong(f"a picture of {header.width} x {header.height} px"))
            if not 0 <= header.taken_ns <= time.monotonic_ns() or not 0 <= header.exposure_ns <= header.taken_ns:
                raise DeviceError(self._wrong("a picture of another time"))
            shape = (*self._shape, 3) if header.channels == 3 else self._shape
            pixels = np.empty(shape, np.uint8)
            view = memoryview(pixels.data).cast("B")
            filled = 0
            while filled < len(view):
                if not (more := self._file.readinto(view[filled:])):
                    raise DeviceError(self._gone("it has ended within a picture"))
                filled += more
        except msgspec.MsgspecError as error:
            raise DeviceError(self._wrong(plain(error))) from error
        except OSError as error:
            raise DeviceError(self._gone(error.strerror or str(error))) from error
        return Image(pixels, header.taken_ns * _S_PER_NS, header.exposure_ns * _S_PER_NS)

    def close(self) -> None:
        """End the connection: the camera then sends no more."""
        self._file.close()
        self._socket.close()

    def _gone(self, why: str) -> Trouble:
        return Trouble(f"{self._path}: the simulated camera does not answer: {why}", "", "run", "giraff run --camera")

    def _wrong(self, what: str) -> Trouble:
        return Trouble(f"{self._path}: the simulated camera says what is none of its protocol: {what}", "end it")
