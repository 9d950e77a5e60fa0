"""Counters of the boards wrap at 32 bits."""

from __future__ import annotations


def signed32(difference: int) -> int:
    """The difference of two wrapping 32-bit counters: the way between them, if it is less than half the circle."""
    return (difference + 0x80000000 & 0xFFFFFFFF) - 0x80000000
