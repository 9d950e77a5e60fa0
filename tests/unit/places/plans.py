"""Drawn floor plans of rooms with doors of all widths, and blocks that stand about in them."""

from random import Random
from typing import Final, NamedTuple

from giraff_core.kinematics.pose import Pose
from giraff_maps.floor_plan import FloorPlan, Wall
from giraff_schemas.places import NoGoLine

CELL: Final = 0.2
"""m. Side of the cells of which walls and blocks are made."""
_LEAST_ROOM: Final = 12
"""Cells of a room's shorter side."""


class Drawn(NamedTuple):
    """A plan with a no-go line on it, and two places with some room about them."""

    plan: FloorPlan
    occupied: list[list[bool]]
    """By column and row."""
    no_go: tuple[NoGoLine, ...]
    start: Pose
    goal: Pose


def drawn(seed: int, side: int = 100) -> Drawn:
    """Draw a square plan of so many cells a side."""
    random = Random(f"{seed}/route")
    occupied = [[column in {0, side - 1} or row in {0, side - 1} for row in range(side)] for column in range(side)]
    _divide(random, occupied, 1, 1, side - 1, side - 1)
    for _ in range(side * side // 250):
        column, row = random.randrange(1, side - 3), random.randrange(1, side - 3)
        for right in range(random.randint(1, 3)):
            for up in range(random.randint(1, 3)):
                occupied[column + right][row + up] = True
    x, y = random.randint(20, side - 20) * CELL, random.randint(20, side - 20) * CELL
    line = NoGoLine(name="line", x=x, y=y, end_x=x + random.uniform(-2.0, 2.0), end_y=y + random.uniform(0.5, 2.0))
    plan = FloorPlan(f"drawn {seed}", tuple(_walls(occupied)))
    return Drawn(plan, occupied, (line,), _place(random, occupied), _place(random, occupied))


def _divide(random: Random, occupied: list[list[bool]], left: int, bottom: int, right: int, top: int) -> None:
    """Part a room by a wall with a door or two, and go on with both."""
    width, depth = right - left, top - bottom
    if max(width, depth) < 2 * _LEAST_ROOM + random.randint(0, 20):
        return
    along_x = width < depth
    low, high = (bottom, top) if along_x else (left, right)
    at = random.randint(low + _LEAST_ROOM, high - _LEAST_ROOM)
    begin, end = (left, right) if along_x else (bottom, top)
    doors = [(random.randrange(begin, end - 8), random.randint(4, 9)) for _ in range(random.randint(1, 3))]
    for each in range(begin, end):
        is_open = any(first <= each < first + wide for first, wide in doors)
        column, row = (each, at) if along_x else (at, each)
        occupied[column][row] = occupied[column][row] or not is_open
    if along_x:
        _divide(random, occupied, left, bottom, right, at)
        _divide(random, occupied, left, at + 1, right, top)
    else:
        _divide(random, occupied, left, bottom, at, top)
        _divide(random, occupied, at + 1, bottom, right, top)


def _walls(occupied: list[list[bool]]) -> list[Wall]:
    """Return the edges between occupied cells and free ones."""
    side = len(occupied)
    walls: list[Wall] = []
    for i in range(1, side):
        for flip in (False, True):
            begin: int | None = None
            for j in range(side + 1):
                one, other = ((i - 1, j), (i, j)) if not flip else ((j, i - 1), (j, i))
                is_edge = j < side and occupied[one[0]][one[1]] != occupied[other[0]][other[1]]
                if is_edge and begin is None:
                    begin = j
                elif not is_edge and begin is not None:
                    ends = (i, begin, i, j) if not flip else (begin, i, j, i)
                    walls.append((ends[0] * CELL, ends[1] * CELL, ends[2] * CELL, ends[3] * CELL))
                    begin = None
    return walls


def _place(random: Random, occupied: list[list[bool]]) -> Pose:
    """Draw a place that has no occupied cell within three cells."""
    side = len(occupied)
    while True:
        column, row = random.randrange(4, side - 4), random.randrange(4, side - 4)
        around = range(-3, 4)
        if not any(occupied[column + right][row + up] for right in around for up in around):
            return Pose((column + 0.5) * CELL, (row + 0.5) * CELL, random.uniform(-3.0, 3.0))
