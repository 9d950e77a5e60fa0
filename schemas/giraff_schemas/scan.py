"""One turn of a laser scanner, as a sample."""

import math
from array import array
from sys import byteorder
from typing import Final

from giraff_schemas.checks import require_finite
from giraff_schemas.messages import RobotTime, Sample
from giraff_schemas.trouble import NO_TROUBLE, Trouble

RAYS: Final = 450
"""Rays of a turn, whatever the speed of the motor."""
SECTORS: Final = 36
"""Sectors of a turn, of 10 degrees each."""
SECTOR_RAYS: Final = tuple(
    range(-(-sector * RAYS // SECTORS), -(-(sector + 1) * RAYS // SECTORS)) for sector in range(SECTORS)
)
"""Numbers of the rays of each sector: twelve or thirteen."""
NEAREST: Final = 60
"""mm. An answer from nearer comes from dirt on the window."""
NO_ECHO: Final = 0
"""A ray that met nothing, in `LaserScan.ranges`."""
OWN: Final = 0x8000
"""Bit of a ray that the robot's own parts hide, beside the mm to them."""
NOT_MEASURED: Final = 0xFFFF
"""A ray of which nothing has come."""
_LONGEST_TURN: Final = 0.5
"""s."""


def scan_frame(sensor: str) -> str:
    """Return the frame of a laser scanner: its axes are upright, also where it hangs upside down."""
    return f"scan_{sensor}_link"


class LaserScan(Sample, frozen=True, kw_only=True):
    """One whole turn of a laser scanner."""

    sensor: str
    """Name in the robot file, as in the key."""
    ranges: bytes
    """mm of each ray as 16 bits, little-endian, in the order in which they were measured."""
    bearing: float
    """rad, counter-clockwise from the x axis of `base_link`: direction of ray 0, from where the scanner sits."""
    step: float
    """rad from each ray to the next; negative: clockwise."""
    duration: float
    """s. Ray i was measured i / `RAYS` of it after ray 0."""
    since_tick: float
    """s from `tick` until ray 0 was measured, as the device's own clock tells."""
    odom: tuple[float, float, float] | None = None
    """Pose of the robot in `odom` when ray 0 was measured: m, m, rad; None: it is not known."""
    blind: tuple[int, ...] = ()
    """Numbers of the sectors that tell nothing, counted as the rays are."""
    trouble: Trouble = NO_TROUBLE
    """Cause, where the scanner itself tells nothing: no ray counts then."""
    tick: RobotTime | None
    """Newest moment that the service held before the turn began."""

    def __post_init__(self) -> None:
        require_finite(self, self.bearing, self.step, self.duration, self.since_tick, *(self.odom or ()))
        if len(self.ranges) != 2 * RAYS:
            raise ValueError(f"ranges has {len(self.ranges)} bytes, and {RAYS} rays are {2 * RAYS}")
        if not 0.0 <= self.duration <= _LONGEST_TURN:
            raise ValueError(f"duration is {self.duration:g} s: a turn takes {_LONGEST_TURN:g} s at most")
        if not 0.0 < abs(self.step) < math.pi or any(not 0 <= sector < SECTORS for sector in self.blind):
            raise ValueError(f"step {self.step:g} or blind {self.blind} is out of range")

    def rays(self) -> "array[int]":
        """Return mm of each ray: `NO_ECHO`, a distance, or from `OWN` on what tells nothing of the surroundings."""
        found = array("H", self.ranges)
        if byteorder == "big":
            found.byteswap()
        return found


def packed(ranges: "array[int]") -> bytes:
    """Return the bytes of `LaserScan.ranges`."""
    if byteorder == "big":
        ranges = ranges[:]
        ranges.byteswap()
    return ranges.tobytes()
