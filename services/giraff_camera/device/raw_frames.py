"""What the simulated camera and its reader say to each other on a Unix socket (SOCK_STREAM).

The reader sends one JSON line, a `Wanted`. The camera then sends pictures for as long as the reader stays: each a JSON
line, a `Header`, and after it `height * width * channels` bytes, row by row.
"""

from typing import Literal

import msgspec


class Wanted(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What the reader asks for."""

    width: int
    height: int
    rate: float
    """Hz."""


class Header(msgspec.Struct, frozen=True, kw_only=True):
    """What stands before each picture."""

    width: int
    height: int
    channels: Literal[1, 3]
    """Grey, or blue, green and red."""
    taken_ns: int
    """CLOCK_MONOTONIC at the beginning of the exposure: both are on one host."""
    exposure_ns: int
