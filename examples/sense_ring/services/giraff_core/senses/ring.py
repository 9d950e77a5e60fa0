"""Rings of infrared distance sensors."""

import math
from typing import Annotated, ClassVar

from giraff_core.bounds import Bounds, check_bounds
from giraff_core.kinematics.parts import ANGLE, PLACE
from giraff_core.senses.sense import Evidence, Sense, Strip, Summary, arc
from giraff_schemas.ring import SENSORS, RingLook
from giraff_schemas.topics import RING, Topic


class IrRing(Sense, frozen=True, kw_only=True, tag="ir-ring"):
    """Sixteen infrared sensors on a circle in `base_link`, each of which looks outward along a line.

    A thin post between two lines is seen only when the robot turns or comes nearer.
    """

    TOPIC: ClassVar[Topic[RingLook]] = RING

    x: Annotated[float, PLACE] = 0.0
    """m. Centre of the circle."""
    y: Annotated[float, PLACE] = 0.0
    yaw: Annotated[float, ANGLE] = 0.0
    """rad. Direction in which sensor number 0 looks."""
    radius: Annotated[float, Bounds(0.0, 1.0, "m")] = 0.0
    """m from the centre to each sensor."""
    reach: Annotated[float, Bounds(0.1, 1.5, "m")] = 1.5
    """m beyond which a distance is not trusted."""

    def __post_init__(self) -> None:
        check_bounds(self)

    def seen(self, look: RingLook) -> list[tuple[float, float]]:
        """Return what stands within reach: m from the centre, rad off the ring's axis."""
        numbered = enumerate(look.distances)
        return [(self.radius + m, n * math.tau / SENSORS) for n, m in numbered if m is not None and m <= self.reach]

    @classmethod
    def summary(cls, sample: RingLook) -> Summary:
        """Return the nearest distance."""
        nearest = min((each for each in sample.distances if each is not None), default=None)
        return Summary("clear" if nearest is None else f"{nearest:.2f} m", nearest)

    def field(self, footprint_radius: float) -> list[Strip]:
        """Return the circle of its reach."""
        del footprint_radius
        return [arc(self.x, self.y, self.radius + self.reach, 0.0, math.pi)]

    def evidence(self, sample: RingLook, footprint_radius: float) -> Evidence:
        """Return a point for each distance."""
        del footprint_radius
        polar = [(far, self.yaw + off) for far, off in self.seen(sample)]
        return Evidence(seen=[[(self.x + far * math.cos(at), self.y + far * math.sin(at))] for far, at in polar])
