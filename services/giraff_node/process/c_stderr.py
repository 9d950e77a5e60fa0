"""Standard error of the C libraries in this process."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import NamedTuple


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
