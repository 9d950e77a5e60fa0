"""Counters and time of the boards wrap at 32 bits, and start anew with the board."""

from __future__ import annotations

from typing import Final

from giraff_schemas.messages import Wheels
from giraff_schemas.trouble import NO_TROUBLE, Trouble

SLACK_TICKS: Final = 4
"""Added to what a wheel may travel between two samples: counts come whole, and the board's time is not exact."""

_WRAP: Final = 1 << 32
_HALF_WRAP: Final = 1 << 31

# Without numbers: a fault that repeats with each sample is then one fault, told once.
_NEW_BOOT: Final = Trouble("the base board has started again", "if nobody reset it, check its supply")
_NEW_BASE: Final = Trouble("wheels come from another base process", "if it was not restarted, end the second one")
_LONG_GAP: Final = Trouble("no wheels for so long that the board's time may have wrapped", "check base and the network")


def signed32(difference: int) -> int:
    """The difference of two wrapping 32-bit counters: the way between them, if it is less than half the circle."""
    return (difference + 0x80000000 & 0xFFFFFFFF) - 0x80000000


def elapsed_us(last: Wheels, wheels: Wheels) -> int:
    """µs of the board's time from one sample of a boot to the next; 0 where `wheels` repeats `last`, or is older."""
    elapsed = (wheels.board_us - last.board_us) % _WRAP
    return elapsed if elapsed < _HALF_WRAP else 0


def restart(last: Wheels, wheels: Wheels) -> Trouble:
    """Why the counters of `wheels` do not go on from those of `last`."""
    if wheels.boot_id != last.boot_id:
        return _NEW_BOOT
    if wheels.instance != last.instance:
        return _NEW_BASE
    # The board's own time says "newer" for half its range only; the robot's clock does not wrap.
    if wheels.tick.robot_ns - last.tick.robot_ns >= _HALF_WRAP * 1000:
        return _LONG_GAP
    return NO_TROUBLE
