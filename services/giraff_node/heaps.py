"""How many heaps the C library keeps for the threads of this process."""

from __future__ import annotations

import ctypes
from typing import Final

_M_ARENA_MAX: Final = -8  # glibc's malloc.h
_HEAPS: Final = 2


def keep_few() -> None:
    """Let threads share two heaps; to be called before there are any.

    glibc gives Zenoh's threads up to eight for each processor, and what is free in one is of no use to another: after
    half an hour on a network full of rubbish a service was 3 MB larger. Other C libraries have no such number.
    """
    if mallopt := getattr(ctypes.CDLL(None), "mallopt", None):
        mallopt(_M_ARENA_MAX, _HEAPS)
