"""What no floor plan may be, whatever file it comes from."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Final

from giraff_maps.floor_plan import FloorPlan, MapError

SMALLEST: Final = 0.5
"""m; of the longer side."""
LARGEST: Final = 200.0
"""m; of either side."""
FARTHEST: Final = 10_000.0
"""m of any wall from (0, 0): farther off, millimetres are lost in single precision."""
MOST_WALLS: Final = 20_000
_MILLIMETRES: Final = 2_000.0  # m; a plan that seems so large has millimetres for metres, not centimetres


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


def _too_large(path: Path, side: float) -> str:
    if path.suffix.lower() != ".toml":
        return "resolution is the side of a cell in metres, most often 0.05"
    unit = "millimetres" if side > _MILLIMETRES else "centimetres"
    return f"are these {unit}? it takes metres"


def _too_small(path: Path) -> str:
    if path.suffix.lower() != ".toml":
        return "resolution is the side of a cell in metres, most often 0.05"
    return "it takes metres"
