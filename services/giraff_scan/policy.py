"""Packets put together to whole turns, and which sectors of them tell nothing. No I/O here."""

import math
from array import array
from collections.abc import Sequence
from typing import Final, NamedTuple

from giraff_core.senses import LaserScanner
from giraff_scan.ld19 import POINTS, POINTS_PER_S, Packet
from giraff_schemas.messages import RobotTime
from giraff_schemas.scan import NEAREST, NO_ECHO, NOT_MEASURED, OWN, RAYS, SECTOR_RAYS, SECTORS
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_STEP: Final = 360.0 / RAYS
_SLOWEST: Final = 7.0
_FASTEST: Final = 13.0
"""Turns a second. The maker allows 5, but then a turn is older than the guard may go by before the next one comes."""
_MEASURED: Final = 0.3
"""Share of a sector's rays that must have come in this turn. Older rays of it are over 0.15 s old."""
_ANSWERED: Final = 0.3
"""Share of them that must meet something, or the sector is dark."""
_DARK: Final = 3
"""Turns in a row after which a dark sector tells nothing: black, glass, open space, or a covered window."""
_TOO_LONG: Final = 1.3
"""Times the length of a turn by the motor's speed, after which its rays do not belong together."""
_TOO_SHORT: Final = 0.5
"""Times that length. In less than this, the zero was only passed twice: packets may overlap a little."""
_SPREADS: Final = (0.5, 2.2)
"""Least and most of the angle that a packet covers, of that by its speed: some make 2300 or 5000 points a second."""
_OFF: Final = 8.0
"""deg between the place where a packet ends and the one that the packet before tells: the clock has steps of 1 ms."""
_REMEMBERED_NS: Final = 100_000_000
_NEWEST: Final = 0.03
"""Share of the newest packet in the share of those that are damaged, which is that of about one turn."""
_DAMAGED: Final = 0.1
"""Share of damaged packets from which on none counts: the checksum of one byte passes one in 256 of them."""

_NOISY: Final = Trouble("more than a tenth of its packets are damaged", "check its cable, and what runs beside it")
_HELD: Final = Trouble("its motor is held, or turns at another speed than it says", "free it, or replace it")


class Turn(NamedTuple):
    """One turn, from the scanner's zero to its zero. Ray i looks i / `RAYS` of a turn clockwise from there."""

    ranges: "array[int]"
    """As `LaserScan.ranges`."""
    blind: tuple[int, ...]
    """Sectors that tell nothing."""
    begun_ns: int
    """Robot's time of ray 0."""
    duration: float
    """s."""
    tick: RobotTime | None
    """Newest moment that was held before its first packet was measured."""


class Sectors:
    """Judges the sectors of each turn."""

    def __init__(self, own: Sequence[bool]) -> None:
        """`own`: whether the robot's own parts are in the way of a ray."""
        self._seen = [sum(not own[ray] for ray in rays) for rays in SECTOR_RAYS]
        self._dark = [0] * SECTORS

    def blind(self, ranges: "array[int]") -> tuple[int, ...]:
        """Return the numbers of those that tell nothing. What the robot hides entirely is no such sector."""
        found = []
        for sector, rays in enumerate(SECTOR_RAYS):
            measured = [mm for mm in ranges[rays.start : rays.stop] if mm < OWN]
            is_dark = len(measured) - measured.count(NO_ECHO) < _ANSWERED * len(measured)
            self._dark[sector] = self._dark[sector] + 1 if is_dark else 0
            if len(measured) < _MEASURED * self._seen[sector] or self._dark[sector] >= _DARK:
                found.append(sector)
        return tuple(found)


class Turns:
    """Takes packets, and gives turns."""

    def __init__(self, scanner: LaserScanner) -> None:
        sense = 1.0 if scanner.upside_down else -1.0
        self._own = [scanner.hides(scanner.yaw + sense * math.radians(ray * _STEP)) for ray in range(RAYS)]
        self._sectors = Sectors(self._own)
        self._reach = round(scanner.reach * 1000)
        self.fault = NO_TROUBLE
        """Cause, where the newest packet must not be trusted."""
        self._last: tuple[float, int] | None = None  # deg and robot's ns of the newest point
        self._rays: array[int] | None = None
        """Rays of the turn that goes on; None: the next one is waited for."""
        self._begun_ns = 0
        self._tick: RobotTime | None = None
        self._damaged = 0.0

    def on_damaged(self) -> None:
        """Take note of a packet whose checksum is wrong."""
        self._damaged += _NEWEST * (1.0 - self._damaged)

    def add(self, packet: Packet, measured_ns: int, tick: RobotTime | None) -> Turn | None:
        """Take a packet whose last point was measured then; return the turn that ends in it."""
        self._damaged -= _NEWEST * self._damaged
        self.fault = _NOISY if self._damaged > _DAMAGED else _fault_of(packet)
        last, end = self._last, (packet.start + packet.spread) % 360.0
        if self.fault:
            self._last, self._rays = None, None
            return None
        if last is not None and measured_ns - last[1] < _REMEMBERED_NS:
            expected = last[0] + packet.speed * (measured_ns - last[1]) * 1e-9
            if abs(math.remainder(end - expected, 360.0)) > _OFF:
                return None  # a damaged one whose checksum is right by chance
        self._last = end, measured_ns
        if self._rays is not None and (measured_ns - self._begun_ns) * 1e-9 > _TOO_LONG * 360.0 / packet.speed:
            self._rays = None
        ended, before = None, packet.start if last is None else last[0]
        for point, mm in enumerate(packet.ranges):
            angle = (packet.start + packet.spread * point / (POINTS - 1)) % 360.0
            if before > angle + 180.0:
                wrapped_ns = measured_ns - round(end / packet.speed * 1e9)
                if self._rays is None or (wrapped_ns - self._begun_ns) * 1e-9 > _TOO_SHORT * 360.0 / packet.speed:
                    ended = self._begin(wrapped_ns, tick)
            if self._rays is not None:
                self._put(min(round(angle / _STEP), RAYS - 1), mm)
            before = angle
        return ended

    def _put(self, ray: int, mm: int) -> None:
        """Keep the nearest of what one ray has met."""
        rays = self._rays
        if rays is None:
            return
        known = mm if NEAREST <= mm <= self._reach else NO_ECHO
        if self._own[ray]:
            known |= OWN
        before = rays[ray]
        if before == NOT_MEASURED or before & ~OWN == NO_ECHO or NO_ECHO < known & ~OWN < before & ~OWN:
            rays[ray] = known

    def _begin(self, now_ns: int, tick: RobotTime | None) -> Turn | None:
        """Begin a turn; return the one that ends."""
        rays, begun_ns, first = self._rays, self._begun_ns, self._tick
        self._rays, self._begun_ns, self._tick = array("H", [NOT_MEASURED]) * RAYS, now_ns, tick
        if rays is None:
            return None
        return Turn(rays, self._sectors.blind(rays), begun_ns, (now_ns - begun_ns) * 1e-9, first)


def _fault_of(packet: Packet) -> Trouble:
    """Return why a packet must not be trusted."""
    if not _SLOWEST <= packet.speed / 360.0 <= _FASTEST:
        what = f"its motor makes {packet.speed / 360.0:.1f} turns a second, not {_SLOWEST:g} to {_FASTEST:g}"
        return Trouble(what, "see that nothing holds it, and that it has 5 V")
    whole = packet.speed * (POINTS - 1) / POINTS_PER_S
    least, most = _SPREADS
    return NO_TROUBLE if least * whole < packet.spread < most * whole else _HELD
