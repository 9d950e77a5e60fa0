"""Bytes of a device that echoes no tick, and a proof of how old they are. No I/O here."""

from collections import deque
from collections.abc import Callable, Iterable
from typing import Final

from giraff_core.freshness import TickFilter
from giraff_core.io import SerialPort
from giraff_schemas.messages import RobotTime, Tick

_LONGEST_WAIT: Final = 50_000_000
"""ns. Bytes that can have waited longer are dropped."""
_SETTLES: Final = 50_000_000
"""ns after a drop in which all is dropped, too: an adapter gives up what it held only when the kernel asks it again."""
_MOST_AT_ONCE: Final = 3900
"""Bytes of one look. With more that waits, the kernel stops an adapter, which then holds what comes."""
_MOST_BYTES: Final = 65536
"""Bytes kept for a service that cuts none of them."""
_MOST_TICKS: Final = 200


class FreshBytes:
    """Keeps the bytes that have just arrived, each with a tick that the service held before it came.

    A board of ours echoes the robot's newest tick, so each of its frames proves its age. The bytes of any other device
    may have waited in the kernel while the process stood still or the machine slept. All that can have waited over
    50 ms is dropped: after the port was opened, after a wake of the machine, after a gap between two turns.

    A service must therefore have a timer of at least 25 Hz, better of 50 Hz: with fewer turns all is dropped. What
    the device or its adapter holds back by itself shows nowhere here. A clock or a count in the device's own packets
    shows it.
    """

    def __init__(self, port: SerialPort, clock: Callable[[], int], *, delay: float) -> None:
        """`clock`: `IO.robot_ns`.

        `delay`: s. Longest from the beginning of a measurement until its first byte has arrived: in the device, on the
        line and in an adapter.
        """
        self.data = bytearray()
        """The bytes that are fresh and not cut off yet, oldest first."""
        self.breaks = 0
        """Number of times that bytes were dropped: what goes over several packets must then begin anew."""
        self._port = port
        self._clock = clock
        self._delay_ns = round(delay * 1e9)
        self._filter = TickFilter()
        self._held: deque[tuple[int, RobotTime]] = deque(maxlen=_MOST_TICKS)  # with the moment from which it was held
        self._ticks: deque[tuple[int, RobotTime | None]] = deque()  # of bytes up to this one, counted from the first
        self._cut = 0  # bytes
        self._clean_from_ns = 0

    def update(self, now: float, ticks: Iterable[Tick]) -> None:
        """Take the ticks that have come, then the bytes. `now`: monotonic, s."""
        for tick in ticks:
            # Ticks that queued up while the process stood are held from now on only.
            moment_ns = self._clock()
            if self._filter.is_newer(tick, moment_ns * 1e-9):
                self._held.append((moment_ns, RobotTime(epoch=tick.epoch, robot_ns=tick.robot_ns)))
        arrival = self._port.poll(now)
        has_waited = arrival.until_ns - arrival.since_ns > _LONGEST_WAIT
        too_many = len(arrival.data) > _MOST_AT_ONCE or len(self.data) > _MOST_BYTES
        if arrival.opened or has_waited or too_many:
            self.breaks += 1
            self._clean_from_ns = arrival.until_ns + _SETTLES
        if arrival.since_ns < self._clean_from_ns:
            self.data.clear()
            self._ticks.clear()
        elif arrival.data:
            self.data += arrival.data
            self._ticks.append((self._cut + len(self.data), self._tick_at(arrival.since_ns - self._delay_ns)))

    def cut(self, length: int) -> tuple[bytes, RobotTime | None]:
        """Remove the first `length` bytes of `data`; return them and the tick of the measurement that they tell.

        It is the newest tick that was held before the first of them was measured; None: none was.
        """
        data, tick = bytes(self.data[:length]), self._ticks[0][1] if self._ticks else None
        del self.data[:length]
        self._cut += len(data)
        while self._ticks and self._ticks[0][0] <= self._cut:
            self._ticks.popleft()
        return data, tick

    def _tick_at(self, moment_ns: int) -> RobotTime | None:
        """Return the newest tick that was held at this moment, which is none before that of the last call."""
        held = self._held
        while len(held) > 1 and held[1][0] <= moment_ns:
            held.popleft()
        return held[0][1] if held and held[0][0] <= moment_ns else None
