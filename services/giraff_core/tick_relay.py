"""The robot's clock on its way down to a board, and back up in the board's frames."""

from typing import Protocol

from giraff_core.freshness import TickFilter
from giraff_schemas.messages import RobotTime, Tick
from giraff_schemas.wire import TickFrame


class _Carrier(Protocol):
    """A frame that carries the newest tick its board held when the measurement began."""

    @property
    def tick_epoch(self) -> int: ...
    @property
    def tick_robot_ns(self) -> int: ...


class TickRelay:
    """Numbers the ticks that go down to one board."""

    def __init__(self) -> None:
        self._seq = 0
        self._clock = TickFilter()

    def frame(self, tick: Tick, now: float) -> TickFrame | None:
        """The robot's clock for the board, which puts the last one into each of its frames; None for an old tick.

        `now`: s of any one monotonic clock.
        """
        if not self._clock.is_newer(tick, now):
            return None
        self._seq = (self._seq + 1) & 0xFFFF
        return TickFrame(seq=self._seq, epoch=tick.epoch, robot_ns=tick.robot_ns)


def tick_of(frame: _Carrier) -> RobotTime | None:
    """The tick in a board's frame; None while the board holds none."""
    return RobotTime(epoch=frame.tick_epoch, robot_ns=frame.tick_robot_ns) if frame.tick_epoch else None
