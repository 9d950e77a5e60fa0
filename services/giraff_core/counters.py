"""Counters and time of the boards wrap at 32 bits, and start anew with the board. By them rest is told, too."""

from typing import Final

from giraff_schemas.messages import Wheels
from giraff_schemas.trouble import NO_TROUBLE, Trouble

RESTS: Final = 0.2
"""s without motion that count as rest. A wheel that creeps by a count each 0.2 s or faster never rests."""
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


class Standstill:
    """For how long both wheels have stood, by the samples of one robot, one after another.

    It is one rule of rest for odometry, motion, base and calibrate. A wheel that rests on the edge of a count goes to
    and fro by one, and its board reports a speed. So a speed cannot tell rest. A wheel stands while its counter stays
    on two neighbouring counts. Each further count of a wheel that creeps leaves them.
    """

    def __init__(self) -> None:
        self.seconds = 0.0
        """s by the board's clock for which neither wheel has moved."""
        self._last: Wheels | None = None
        self._above = 0, 0  # counts of each wheel above the lower of its two neighbours

    @property
    def is_rest(self) -> bool:
        """Whether the robot rests."""
        return self.seconds >= RESTS

    def on_wheels(self, wheels: Wheels) -> None:
        """Take the next sample. A new start of the board or of base begins anew."""
        last = self._last
        if last is None or restart(last, wheels):
            self._last, self.seconds, self._above = wheels, 0.0, (0, 0)
            return
        if not (elapsed := elapsed_us(last, wheels) / 1e6):
            return
        self._last = wheels
        left = self._above[0] + signed32(wheels.left_ticks - last.left_ticks)
        right = self._above[1] + signed32(wheels.right_ticks - last.right_ticks)
        self._above = min(max(left, 0), 1), min(max(right, 0), 1)
        self.seconds = self.seconds + elapsed if self._above == (left, right) else 0.0
