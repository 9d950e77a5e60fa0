"""A floor plan: walls as segments, whatever file they come from."""

from __future__ import annotations

from typing import NamedTuple

Wall = tuple[float, float, float, float]
"""m; from x, y to x, y."""


class MapError(Exception):
    """A map that cannot be used. The message names the file and the place in it, the likely cause and the way out."""


class Bounds(NamedTuple):
    """m."""

    left: float
    bottom: float
    right: float
    top: float


class FloorPlan(NamedTuple):
    """What stands on a floor: never empty, all finite."""

    name: str
    walls: tuple[Wall, ...]

    @property
    def bounds(self) -> Bounds:
        """The rectangle about all walls."""
        xs = [x for wall in self.walls for x in (wall[0], wall[2])]
        ys = [y for wall in self.walls for y in (wall[1], wall[3])]
        return Bounds(min(xs), min(ys), max(xs), max(ys))
