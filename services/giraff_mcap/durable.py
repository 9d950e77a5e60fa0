"""A file that is on disk up to its last `sync`, whatever happens to process, disk and power."""

from __future__ import annotations

import contextlib
import io
import os
from pathlib import Path
from typing import Any


class DurableFile(io.BufferedIOBase):
    """Takes what is written into memory; `sync` puts all of it on disk, or leaves the file as it was."""

    def __init__(self, path: Path) -> None:
        """Makes the file. Raises OSError, FileExistsError where it is there already: nothing is written over."""
        super().__init__()
        self._pending = bytearray()
        self._synced = 0
        self._file = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o644)
        folder = os.open(path.resolve().parent, os.O_RDONLY | os.O_DIRECTORY)
        try:
            os.fsync(folder)  # the name is only then on disk, too
        finally:
            os.close(folder)

    def write(self, data: Any, /) -> int:
        """Raises nothing: only `sync` touches the disk."""
        before = len(self._pending)
        self._pending += data
        return len(self._pending) - before

    def tell(self) -> int:
        return self._synced + len(self._pending)

    def sync(self) -> None:
        """Raises OSError; then the file ends where it did before, between two records."""
        try:
            pending = bytes(self._pending)
            while pending:
                pending = pending[os.write(self._file, pending) :]
            os.fdatasync(self._file)
        except OSError:
            self._pending.clear()
            with contextlib.suppress(OSError):
                os.ftruncate(self._file, self._synced)
                os.lseek(self._file, self._synced, os.SEEK_SET)
            raise
        self._synced, self._pending = self.tell(), bytearray()

    def close(self) -> None:
        """Lets go of it; what was not synced is not in it."""
        if not self.closed:
            os.close(self._file)
        super().close()
