"""A camera at a Unix socket, as the simulated one is. It sees a pattern and noise, which move."""

import socket
import threading
import time
from contextlib import suppress
from pathlib import Path
from typing import Final, Self

import msgspec
import numpy as np

from giraff_camera.device.raw_frames import Header, Wanted

_NOISE: Final = 20
"""Grey levels. A full picture has some 15 kB then, at the quality of the robot file."""


class MovingCamera:
    """One reader at a time, until the end of the block."""

    def __init__(self, path: Path) -> None:
        self._listener = socket.socket(socket.AF_UNIX)
        self._listener.bind(str(path))
        self._listener.listen()
        self._chance = np.random.default_rng(1)
        self.taken = 0
        """Pictures that a reader has been given."""

    def __enter__(self) -> Self:
        threading.Thread(target=self._serve, daemon=True).start()
        return self

    def __exit__(self, *_: object) -> None:
        self._listener.shutdown(socket.SHUT_RDWR)
        self._listener.close()

    def _serve(self) -> None:
        with suppress(OSError):  # the end of the block
            while True:
                reader, _ = self._listener.accept()
                with reader, suppress(OSError):
                    self._show(reader, msgspec.json.decode(reader.makefile("rb").readline(), type=Wanted))

    def _show(self, reader: socket.socket, wanted: Wanted) -> None:
        columns, rows = np.meshgrid(np.arange(wanted.width), np.arange(wanted.height))
        due = time.monotonic()
        while True:
            due += 1.0 / wanted.rate
            time.sleep(max(0.0, due - time.monotonic()))
            noise = self._chance.integers(0, _NOISE, columns.shape)
            grey = ((columns + 5 * self.taken + rows) // 2 + noise).astype(np.uint8)
            header = Header(
                width=wanted.width,
                height=wanted.height,
                channels=1,
                taken_ns=time.monotonic_ns(),
                exposure_ns=10_000_000,
            )
            reader.sendall(msgspec.json.encode(header) + b"\n" + grey.tobytes())
            self.taken += 1
