"""Laser scanners: where they are, how far they see, and what the robot itself hides from them."""

import math
from typing import Annotated, ClassVar, Final

from giraff_core.bounds import Bounds, check_bounds
from giraff_core.kinematics.parts import ANGLE, PLACE
from giraff_core.senses.sense import Evidence, Sense, Strip, Summary, arc
from giraff_schemas.frames import BASE_FRAME, Transform
from giraff_schemas.scan import NO_ECHO, OWN, SECTORS, LaserScan, scan_frame
from giraff_schemas.topics import SCAN, Topic

_QUARTERS: Final = ("ahead", "left", "behind", "right")
_SHOWN: Final = 3
"""Rays of which screens are shown the nearest: 2.4 degrees."""
_JOINED: Final = 0.2
"""m between two places up to which screens draw a line."""


class LaserScanner(Sense, frozen=True, kw_only=True, tag="ld19"):
    """A scanner LD06, LD19 or STL-19P that looks all round in a plane: metres, radians in `base_link`.

    `giraff calibrate scan` measures its place, and what the robot's own parts hide.
    """

    TOPIC: ClassVar[Topic[LaserScan]] = SCAN

    x: Annotated[float, PLACE]
    y: Annotated[float, PLACE]
    z: Annotated[float, Bounds(0.02, 2.0, "m", "how many metres above the floor is its window?")] = 0.2
    """m above the floor of the plane in which it sees."""
    yaw: Annotated[float, ANGLE]
    """rad. Direction of its zero: the arrow on its housing."""
    upside_down: bool = False
    """It hangs with its cap down, so that it turns counter-clockwise."""
    reach: Annotated[float, Bounds(0.5, 12.0, "m")] = 12.0
    """m beyond which a distance is not trusted."""
    own: tuple[tuple[float, float], ...] | None = None
    """Arcs that the robot's own parts hide: rad from its zero, each counter-clockwise from the first to the second.
    None: nobody has looked for them, and the robot creeps. Empty: nothing hides anything."""

    def __post_init__(self) -> None:
        check_bounds(self)
        for begin, end in self.own or ():
            if not (-math.tau <= begin < end <= math.tau):  # NaN, too
                raise ValueError(f"own has the arc {begin:g} to {end:g}: give radians, the smaller one first")

    def transform(self, name: str) -> Transform:
        """Return where the scanner of this name is. Its frame is upright, as its rays are told."""
        return Transform(
            parent=BASE_FRAME, child=scan_frame(name), x=self.x, y=self.y, z=self.z, yaw=self.yaw, fixed=True
        )

    def hides(self, bearing: float) -> bool:
        """Return whether the robot's own parts are in a direction: rad in `base_link`."""
        return any((bearing - self.yaw - begin) % math.tau <= end - begin for begin, end in self.own or ())

    @classmethod
    def summary(cls, sample: LaserScan) -> Summary:
        """Return the nearest distance in each quarter about the robot's axes."""
        if sample.trouble:
            return Summary("fault", None, sample.trouble)
        nearest: dict[str, int] = {}
        for ray, mm in enumerate(sample.rays()):
            if NO_ECHO < mm < OWN:
                quarter = _QUARTERS[round((sample.bearing + ray * sample.step) / (math.pi / 2.0)) % 4]
                nearest[quarter] = min(mm, nearest.get(quarter, mm))
        words = [f"{quarter} {nearest[quarter] / 1000:.2f} m" for quarter in _QUARTERS if quarter in nearest]
        words += [f"{len(sample.blind)} of {SECTORS} sectors blind"] * bool(sample.blind)
        return Summary(", ".join(words) or "clear", min(nearest.values()) / 1000 if nearest else None)

    def field(self, footprint_radius: float) -> list[Strip]:
        """Return the circle of its reach."""
        del footprint_radius
        return [arc(self.x, self.y, self.reach, 0.0, math.pi)]

    def evidence(self, sample: LaserScan, footprint_radius: float) -> Evidence:
        """Return lines along what it sees, of the nearest of each few rays."""
        del footprint_radius
        strips: list[list[tuple[float, float]]] = []
        rays = () if sample.trouble else sample.rays()
        for first in range(0, len(rays), _SHOWN):
            seen = [(mm, ray) for ray, mm in enumerate(rays[first : first + _SHOWN], first) if NO_ECHO < mm < OWN]
            if not seen:
                continue
            mm, ray = min(seen)
            bearing = sample.bearing + ray * sample.step
            place = self.x + mm * math.cos(bearing) / 1000, self.y + mm * math.sin(bearing) / 1000
            if strips and math.dist(strips[-1][-1], place) < _JOINED:
                strips[-1].append(place)
            else:
                strips.append([place])
        return Evidence(seen=strips)
