"""A floor plan: walls as segments, whatever file they come from, and what none may be."""

import math
from pathlib import Path
from typing import Final, NamedTuple

from giraff_schemas.checks import refuse_to_read

Wall = tuple[float, float, float, float]
"""m; from x, y to x, y."""

SMALLEST: Final = 0.5
"""m; of the longer side."""
LARGEST: Final = 200.0
"""m; of either side."""
FARTHEST: Final = 10_000.0
"""m of any wall from (0, 0): farther off, millimetres are lost in single precision."""
_MOST_AREA: Final = 2000.0
"""m² of the rectangle about a plan that is computed with: localization's table has 29 kB for each m²."""
MOST_WALLS: Final = 20_000
_MILLIMETRES: Final = 2_000.0  # m; a plan that seems so large has millimetres for metres, not centimetres


class MapError(Exception):
    """A map that cannot be used. The message names the file and the place in it, the likely cause and the way out."""


def at_home(path: Path) -> Path:
    """Return the path with the home folder in place of a leading `~`, which no shell replaces in a file."""
    try:
        return path.expanduser()
    except RuntimeError:  # there is no such user
        return path


def require_file(path: Path) -> None:
    """Raise MapError for what is there and is no regular file."""
    if why := refuse_to_read(path):
        raise MapError(why)


def read_text(path: Path) -> str:
    """Return the text of a file, less a byte order mark. Raises MapError; ValueError where it is no text."""
    try:
        require_file(path)
        return path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise MapError(f"{path}: cannot be read: {error.strerror}") from error


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


def usable(plan: FloorPlan, path: Path) -> FloorPlan:
    """The plan itself. Raises MapError where it has no walls, too many, or a size that no home has."""
    if not plan.walls:
        raise MapError(f"{path}: it has no walls and no posts, so there is nothing to find the robot by: draw some")
    if len(plan.walls) > MOST_WALLS:
        raise MapError(f"{path}: more than {MOST_WALLS} walls: clean it of specks, or use a coarser resolution")
    if not all(math.isfinite(value) for wall in plan.walls for value in wall):
        raise MapError(f"{path}: a wall has a point that is not finite")
    left, bottom, right, top = plan.bounds
    width, height = right - left, top - bottom
    if max(map(abs, plan.bounds)) > FARTHEST:
        raise MapError(
            f"{path}: it lies at ({left:g}, {bottom:g}) m, more than {FARTHEST / 1000.0:g} km from (0, 0): are these "
            "coordinates of the earth? Take a corner of the building for the origin"
        )
    if max(width, height) > LARGEST:
        raise MapError(f"{path}: {width:g} x {height:g} m is too large: {_too_large(path, max(width, height))}")
    if max(width, height) < SMALLEST:
        raise MapError(f"{path}: {width:g} x {height:g} m is too small: {_too_small(path)}")
    return plan


def require_area(plan: FloorPlan) -> None:
    """Raise MapError where a plan is too large to compute with."""
    left, bottom, right, top = plan.bounds
    if (right - left) * (top - bottom) > _MOST_AREA:
        raise MapError(
            f"the map {plan.name!r} is {right - left:.0f} m by {top - bottom:.0f} m, more than {_MOST_AREA:.0f} m²: is "
            "it in metres? Give it the part where the robot drives"
        )


def _too_large(path: Path, side: float) -> str:
    if path.suffix.lower() != ".toml":
        return "resolution is the side of a cell in metres, most often 0.05"
    unit = "millimetres" if side > _MILLIMETRES else "centimetres"
    return f"are these {unit}? it takes metres"


def _too_small(path: Path) -> str:
    if path.suffix.lower() != ".toml":
        return "resolution is the side of a cell in metres, most often 0.05"
    return "it takes metres"
