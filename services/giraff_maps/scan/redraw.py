"""Lays a new plan on an older one of the same home: what the drive saw is of the new one, all else stays."""

import math
from collections.abc import Generator, Iterator, Sequence
from typing import Final

import numpy as np

from giraff_core.kinematics.pose import Pose
from giraff_maps.floor_plan import FloorPlan, MapError, Wall
from giraff_maps.scan.match import Cloud, Floats, match
from giraff_maps.scan.occupancy import OCCUPIED, UNKNOWN, OccupancyGrid
from giraff_maps.scan.plan import MadePlan
from giraff_maps.scan.plan_walls import PlanWalls
from giraff_maps.scan.search import are_apart

_APART: Final = 0.05  # m between two points of a wall
_LARGEST: Final = 2000.0  # m² of the rectangle about a plan
_PLACES: Final = 0.2  # m between two places that are tried
_HEADINGS: Final[Floats] = np.arange(120.0) * (math.tau / 120)
_TRIED: Final = 40
_SPREAD: Final = (0.3, 0.3, 0.1)  # m, m, rad off a place that is tried
_LEAST: Final = 0.7  # share of the new walls that must lie on old ones
_LEAD: Final = 0.15  # share by which the best place must explain more than another one
_SHORTEST: Final = 0.15  # m of an old wall that stays


def placed_on(old: FloorPlan, new: MadePlan) -> Pose:
    """Return the pose of the mapper's frame in the old plan. Raises MapError where that is not clear."""
    left, bottom, right, top = old.bounds
    if (right - left) * (top - bottom) > _LARGEST:
        raise MapError(f"{old.name!r} is larger than {_LARGEST:.0f} m²: give it the part where the robot drives")
    field = PlanWalls(old)
    for _ in field.build():
        pass
    cloud = _cloud(new.walls, new.start)
    xs, ys = np.arange(left, right + _PLACES, _PLACES), np.arange(bottom, top + _PLACES, _PLACES)
    places = np.stack(np.meshgrid(xs, ys), axis=-1).reshape(-1, 2)
    tried = _result(field.best(cloud.points, places, _HEADINGS, _TRIED))
    best, *others = sorted((match(field, cloud, each, _SPREAD) for each in tried), key=lambda each: -each.share)
    rival = next((each.share for each in others if are_apart(each.pose, best.pose, 0.35, 0.2)), 0.0)
    if best.share < _LEAST:
        raise MapError(f"it fits {old.name!r} badly: another plan, or much has moved")
    if rival > best.share - _LEAD:
        raise MapError(f"it fits {old.name!r} in several places: drive through more rooms")
    x, y, yaw = map(float, best.pose)
    return Pose(x, y, yaw)


def _result(parts: Generator[None, None, list[Floats]]) -> list[Floats]:
    """Do all parts at once, and return what comes of them."""
    while True:
        try:
            next(parts)
        except StopIteration as end:
            found: list[Floats] = end.value
            return found


def redrawn(old: FloorPlan, new: MadePlan) -> MadePlan:
    """Return both in one. `new`: made in the frame of the old one."""
    kept = tuple(wall for each in old.walls for wall in _unseen(each, new.grid))
    return new._replace(walls=new.walls + kept, grid=_with_walls(new.grid, kept))


def _cloud(walls: Sequence[Wall], start: Pose) -> Cloud:
    """Return points along walls, in the frame that has this pose in theirs: what was seen is at the right."""
    points, normals = [], []
    for x, y, end_x, end_y in walls:
        points.append(_along((x, y, end_x, end_y)))
        length = math.hypot(end_x - x, end_y - y)
        normals.append(np.full_like(points[-1], ((end_y - y) / length, (x - end_x) / length)))
    origin = Pose(0.0, 0.0, 0.0).seen_from(start)
    return Cloud(np.concatenate(points), np.concatenate(normals)).placed(origin)


def _along(wall: Wall) -> Floats:
    """Return points from the beginning to the end."""
    x, y, end_x, end_y = wall
    part = np.linspace(0.0, 1.0, max(2, math.ceil(math.hypot(end_x - x, end_y - y) / _APART) + 1))[:, None]
    points: Floats = (1.0 - part) * (x, y) + part * (end_x, end_y)
    return points


def _unseen(wall: Wall, grid: OccupancyGrid) -> Iterator[Wall]:
    """Yield the pieces of a wall that the drive did not see: not even a cell beside them."""
    points = _along(wall)
    column, row = np.floor((points - grid.low) / grid.cell).astype(int).T + 1
    known = np.pad(grid.state != UNKNOWN, 2)
    near = np.zeros(len(points), bool)
    columns, rows = np.clip(column + 1, 1, known.shape[0] - 2), np.clip(row + 1, 1, known.shape[1] - 2)
    for aside in (-1, 0, 1):
        for upward in (-1, 0, 1):
            near |= known[columns + aside, rows + upward]
    borders = np.flatnonzero(np.diff(np.concatenate([[True], near, [True]]).astype(int)))
    for first, last in zip(borders[::2], borders[1::2] - 1, strict=True):
        if math.dist(points[first], points[last]) >= _SHORTEST or last - first + 1 == len(points):
            yield (*map(float, points[first]), *map(float, points[last]))  # type: ignore[misc]


def _with_walls(grid: OccupancyGrid, walls: Sequence[Wall]) -> OccupancyGrid:
    """Return a grid that is as large as the walls need, with them drawn in it."""
    if not walls:
        return grid
    points = np.concatenate([_along(wall) for wall in walls])
    before = np.maximum(0, np.ceil((grid.low - points.min(axis=0)) / grid.cell).astype(int) + 1)
    high = grid.low + np.array(grid.state.shape) * grid.cell
    after = np.maximum(0, np.ceil((points.max(axis=0) - high) / grid.cell).astype(int) + 1)
    state = np.pad(grid.state, tuple(zip(before, after, strict=True)), constant_values=UNKNOWN)
    larger = OccupancyGrid(state, grid.low - before * grid.cell, grid.cell)
    larger.state.reshape(-1)[larger.flat(points)] = OCCUPIED
    return larger
