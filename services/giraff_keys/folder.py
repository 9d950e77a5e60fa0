"""The folder of keys on disk. What is in it is whole or not there, and no private key is ever readable by others.

A folder is built under a hidden name and renamed when all of it is on disk. What a crash leaves under such names is
cleared away by whoever next holds the folder around it.
"""

import contextlib
import errno
import fcntl
import os
import shutil
import stat
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Final

_NEW: Final = ".giraff-new"
_OLD: Final = ".giraff-old"
_PRIVATE: Final = 0o600
_PUBLIC: Final = 0o644
_OTHERS: Final = stat.S_IRWXG | stat.S_IRWXO


@contextlib.contextmanager
def holding(folder: Path) -> Iterator[None]:
    """Nobody else changes what is in this folder meanwhile. Raises OSError."""
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX)  # ends with this process, however that ends
        _clear_up(folder)
        yield
    finally:
        os.close(descriptor)


def lay_down(target: Path, public: Mapping[str, bytes], private: Mapping[str, bytes], *, renew: bool = False) -> None:
    """Make the folder `target` of these files, or with `renew` put it in the place of the one that is there.

    The folder around it is held. Raises OSError; then there is what was there before, or the new one, whole.
    """
    new, old = (target.with_name(f".{target.name}{suffix}") for suffix in (_NEW, _OLD))
    try:
        new.mkdir(mode=0o700)
        new.chmod(0o700)  # whatever the umask took away
        for name, data in public.items():
            _write(new / name, data, _PUBLIC)
        for name, data in private.items():
            _write(new / name, data, _PRIVATE)
        _sync(new)
        if renew:
            target.rename(old)
        new.rename(target)
        _sync(target.parent)
    except OSError as error:
        if error.filename:  # a hidden one, which tells nobody anything
            error.filename = str(target.parent.absolute())
        raise
    finally:
        with contextlib.suppress(OSError):  # then the next one who holds the folder does it
            _clear_up(target.parent)


def is_readable_by_others(path: Path) -> bool:
    """Whether anyone but the owner may do anything with the file. Raises OSError."""
    return bool(path.stat().st_mode & _OTHERS)


def _clear_up(folder: Path) -> None:
    """A renewal that got as far as the new folder is completed; one that did not is taken back."""
    for old in folder.glob(f".*{_OLD}"):
        place = folder / old.name.removeprefix(".").removesuffix(_OLD)
        if place.exists():
            shutil.rmtree(old)
        else:
            old.rename(place)
    for new in folder.glob(f".*{_NEW}"):
        shutil.rmtree(new)


def _write(path: Path, data: bytes, mode: int) -> None:
    # Made with its final permissions: changed afterwards, there would be a moment in which others can open it.
    descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, mode)
    with open(descriptor, "wb") as file:  # noqa: PTH123
        os.fchmod(descriptor, mode)  # whatever the umask took away
        if mode == _PRIVATE and is_readable_by_others(path):
            raise OSError(
                errno.ENOTSUP, "file permissions do not hold here: keep keys on a Linux file system", str(path)
            )
        file.write(data)
        file.flush()
        os.fsync(descriptor)


def _sync(folder: Path) -> None:
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
