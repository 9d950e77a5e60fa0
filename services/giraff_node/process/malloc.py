"""How the C library keeps the memory that this process frees."""

from __future__ import annotations

import ctypes
from typing import Final

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
