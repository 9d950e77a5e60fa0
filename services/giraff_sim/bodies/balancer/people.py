"""What acts on a robot that balances: people, slopes, thresholds, walls."""

import math
from typing import Final, NamedTuple

PUSH_S: Final = 0.2
"""s that a push lasts."""


class Spring(NamedTuple):
    """A person who holds the robot at a height, as soft as a spring."""

    place: float
    """m along the robot's way."""
    height: float
    """m above the axle."""
    stiffness: float
    """N/m."""
    damping: float = 0.0
    """N s/m."""

    def force(self, place: float, speed: float) -> float:
        """N on the robot whose point at that height is there and moves."""
        return -self.stiffness * (place - self.place) - self.damping * speed


class Threshold(NamedTuple):
    """A bar on the floor, across the way of both wheels."""

    place: float
    """m along the robot's way."""
    height: float
    width: float = 0.04

    def rise(self, place: float, radius: float) -> float:
        """Return the tangent of the axle's path where a wheel rolls over an edge."""
        reach = math.sqrt(2.0 * radius * self.height - self.height**2)
        rise = 0.0
        for sign, edge in ((1.0, self.place), (-1.0, self.place + self.width)):
            before = sign * (edge - place)  # m, seen from the low side
            if 0.0 < before < reach:
                soft = min(1.0, (reach - before) / 0.01)  # the tyre gives by a centimetre
                rise += sign * soft * before / math.sqrt(radius**2 - before**2)
        return rise


class Loads:
    """All that acts on one robot now. Assign to it."""

    __slots__ = ("bag", "force", "grip", "height", "lift", "slope", "spring", "threshold")

    def __init__(self) -> None:
        self.force = 0.0
        """N forward on the robot, at `height`."""
        self.height = 0.8
        """m above the axle."""
        self.bag = 0.0
        """N m by which something that hangs on the robot tips it forward."""
        self.slope = 0.0
        """rad of the floor, uphill positive."""
        self.lift = 0.0
        """Share of the weight that a person carries. At 1 the wheels are in the air."""
        self.grip: float | None = None
        """rad of lean at which a person holds it firmly, the wheels on the floor."""
        self.spring: Spring | None = None
        self.threshold: Threshold | None = None


def half_sine(impulse: float, seconds: float) -> float:
    """N of a push of so many N s, so long after it began."""
    if not 0.0 <= seconds <= PUSH_S:
        return 0.0
    return impulse / PUSH_S * math.pi / 2.0 * math.sin(math.pi * seconds / PUSH_S)
