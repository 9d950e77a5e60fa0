"""Where a run keeps its ports, sockets and logs; and what is left behind by runs that were killed."""

import contextlib
import fcntl
import os
import shutil
import stat
import tempfile
import time
from pathlib import Path
from typing import Final

from giraff_core.network import NetworkConfig
from giraff_node.network.sockets import remove_stale_sockets, socket_folder

_PREFIX: Final = "giraff-run-"
_LOCK: Final = "running"
_OF_RUNS: Final = "[23][0-9][0-9][0-9][0-9]"  # folders of sockets: by the ports that `free_port` gives
_ABANDONED: Final = 60.0  # s; a younger folder of sockets may belong to a run that is just starting


class RunDirectory:
    """A fresh directory, held by a lock that ends with this process however that ends."""

    def __init__(self) -> None:
        """Also removes the directories that are nobody's any more."""
        _remove_abandoned(Path(tempfile.gettempdir()))
        self.path = Path(tempfile.mkdtemp(prefix=_PREFIX))
        made = self.path / f".{_LOCK}"
        self._lock = made.open("w")
        fcntl.flock(self._lock, fcntl.LOCK_EX)
        made.rename(self.path / _LOCK)  # only now can another run see it, and find it held

    def remove(self) -> None:
        shutil.rmtree(self.path)
        self._lock.close()

    def keep(self) -> None:
        """Leave it to who wants to read the logs: no other run removes it."""
        (self.path / _LOCK).unlink()
        self._lock.close()


def run_directories() -> tuple[list[Path], float | None]:
    """Return the directories of this user's runs that go on; where none does, the last one with logs.

    With it: when that one ended, in s since 1970. None: they go on.
    """
    left: list[tuple[float, Path]] = []
    going_on: list[Path] = []
    for path in Path(tempfile.gettempdir()).glob(f"{_PREFIX}*"):
        with contextlib.suppress(OSError):  # another's, or just gone
            status, lock = path.lstat(), path / _LOCK
            if not stat.S_ISDIR(status.st_mode) or status.st_uid != os.getuid():
                continue
            if lock.exists() and not _is_free(lock):
                going_on.append(path)
            elif written := [log.lstat().st_mtime for log in path.glob("*.log")]:
                left.append((max(status.st_mtime, *written), path))  # a run that was killed leaves only its logs newer
    if going_on or not left:
        return going_on, None
    ended, last = max(left)
    return [last], ended


def remove_run_sockets(network: NetworkConfig) -> None:
    """Remove the folder where the parts of a run met, and those of runs that were killed. One that is in use stays."""
    own = socket_folder(network)
    for folder in () if network.sockets else own.parent.glob(_OF_RUNS):  # others may meet in a folder that has a name
        after = 0.0 if folder == own else _ABANDONED
        with contextlib.suppress(OSError):  # in use, or just gone
            status = folder.lstat()
            is_mine = stat.S_ISDIR(status.st_mode) and status.st_uid == os.getuid()
            if is_mine and time.time() - status.st_mtime >= after:
                remove_stale_sockets(folder, after)
                folder.rmdir()


def _remove_abandoned(parent: Path) -> None:
    for lock in parent.glob(f"{_PREFIX}*/{_LOCK}"):
        with contextlib.suppress(OSError):  # another's, or just gone
            if lock.parent.lstat().st_uid == os.getuid() and _is_free(lock):
                shutil.rmtree(lock.parent)


def _is_free(path: Path) -> bool:
    with path.open("r+", encoding="utf-8") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return False
        return True
