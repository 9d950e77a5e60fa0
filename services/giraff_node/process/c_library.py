"""The C library in this process: how it keeps the memory that is freed, and what it prints to standard error."""

import ctypes
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import Final, NamedTuple

# Names and numbers of glibc's malloc.h; its manual, "Malloc Tunable Parameters".
_M_TRIM_THRESHOLD: Final = -1
_M_MMAP_THRESHOLD: Final = -3
_M_ARENA_MAX: Final = -8
_HEAPS: Final = 2
_LARGE: Final = 128 << 10
"""bytes; glibc's own value. Unless it is set, each larger block that is freed raises it, and keeps more of a heap."""
_KEPT: Final = 32 << 20
"""bytes; glibc takes no larger threshold."""


def keep_freed_memory() -> None:
    """Use large blocks again and again, and give nothing back to the kernel.

    A picture's arrays are made anew for each one. The kernel clears each page that it gives, which took a third of the
    processor time of a rendered picture.
    """
    if mallopt := getattr(ctypes.CDLL(None), "mallopt", None):
        mallopt(_M_MMAP_THRESHOLD, _KEPT)
        mallopt(_M_TRIM_THRESHOLD, 2 * _KEPT)


def limit_heaps() -> None:
    """Let threads share two heaps, and give back what is large and free; to be called before there are any.

    glibc gives Zenoh's threads up to eight for each processor, and what is free in one is of no use to another: after
    half an hour on a network full of rubbish a service was 3 MB larger. Other C libraries have no such numbers.
    """
    if mallopt := getattr(ctypes.CDLL(None), "mallopt", None):
        mallopt(_M_ARENA_MAX, _HEAPS)
        mallopt(_M_MMAP_THRESHOLD, _LARGE)


class _Streams(NamedTuple):
    current: ctypes.c_void_p
    """The C variable `stderr`."""
    own: int | None
    null: int | None


@contextmanager
def muted_c_stderr() -> Iterator[None]:
    """Drop what C libraries print to `stderr` meanwhile, from any thread. Keep it short.

    libjpeg prints a line for each picture that has a byte too many, and OpenCV gives no way to turn that off. The
    descriptor stays as it is: the lines of Python, of its faulthandler and of OpenCV itself still come. With a C
    library other than glibc, whose `stderr` may be constant, nothing is dropped.
    """
    if (streams := _streams()) is None:
        yield
        return
    streams.current.value = streams.null
    try:
        yield
    finally:
        streams.current.value = streams.own


@cache
def _streams() -> _Streams | None:
    library = ctypes.CDLL(None)
    if not hasattr(library, "gnu_get_libc_version"):
        return None
    library.fopen.restype = ctypes.c_void_p
    null: int | None = library.fopen(b"/dev/null", b"we")
    current = ctypes.c_void_p.in_dll(library, "stderr")
    return None if null is None else _Streams(current, current.value, null)
