"""What an ultrasonic sensor is expected to hear, at every place of a floor plan and in every direction.

It is computed once, by casting rays: a filter that asks for thousands of particles ten times a second could not. The
sensor hears the nearest surface in its cone whose normal is not too far off its axis; what is more slanted answers by
chance, and often by a detour.
"""

import itertools
import math
from collections.abc import Generator, Iterator
from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

from giraff_localization.free_space import CELL, Floats, FreeSpace
from giraff_maps.floor_plan import FloorPlan

BIN: Final = 0.02
"""m of range that count as one."""
CLEAR: Final = 251
"""Nothing is in the cone within the sensor's reach."""
SLANTED: Final = 252
"""Something is, but too slanted: an echo of it, by a detour, or none; all are likely."""
SOLID: Final = 253
"""Within a wall, or outside."""

HEADINGS: Final = 72
_RAYS: Final = 2 * HEADINGS
_RAY: Final = math.tau / _RAYS
"""rad from one to the next."""
_BLOCK: Final = 16
"""Cells on each side of what is computed at once."""
_PART: Final = 1_000_000
"""Pairs of a place and a ray that one part tries on walls: 0.01 to 0.03 s, after which the service turns."""
_PER_TRIED_WALL: Final = 2_000
"""Pairs that take as long as all else that is done for a wall in reach."""
_PER_WALL: Final = 10
"""Pairs that take as long as to find out whether a wall is in reach."""
_AT_ONCE: Final = 64
"""Walls whose directions are computed at once."""

_Floats = npt.NDArray[np.float32]


class Cone(NamedTuple):
    """Bounds of what a sensor hears."""

    reach: float
    """m"""
    half_cone: float
    """rad"""
    incidence: float
    """rad"""


class RangeTable:
    """Filled by `build`; until then nothing is expected anywhere."""

    def __init__(self, plan: FloorPlan, space: FreeSpace, cone: Cone) -> None:
        self._walls = np.array(plan.walls, np.float32)
        self._space, self._cone = space, cone
        self.bin = max(BIN, cone.reach / (CLEAR - 1))
        """m of range that count as one: 2 cm, or more for a sensor that hears farther than 5 m."""
        self._table = np.full((space.columns, space.rows, HEADINGS), CLEAR, np.uint8)
        self._flat = self._table.reshape(-1)
        self._near_free = _grown(space.is_free, math.ceil(1.0 / CELL / 2.0))
        self._table[~self._near_free] = SOLID

    def expected(self, x: Floats, y: Floats, heading: Floats) -> npt.NDArray[np.uint8]:
        """Return for a sensor there the range in bins, or CLEAR, SLANTED, SOLID."""
        space = self._space
        column, row = space.cells(x, y)
        direction = np.rint(heading * (HEADINGS / math.tau)).astype(np.int32) % HEADINGS
        found: npt.NDArray[np.uint8] = self._flat[(column * space.rows + row) * HEADINGS + direction]
        return found

    def build(self) -> Iterator[float]:
        """Fill it in parts that stay small however many walls there are. Yields the share that is done after each."""
        corners = itertools.product(range(0, self._space.columns, _BLOCK), range(0, self._space.rows, _BLOCK))
        blocks = [(slice(column, column + _BLOCK), slice(row, row + _BLOCK)) for column, row in corners]
        blocks = [block for block in blocks if self._near_free[block].any()]
        tried = 0
        for number, block in enumerate(blocks):
            for more in self._fill(*block):
                tried += more
                if tried >= _PART:
                    yield number / len(blocks)
                    tried = 0
        yield 1.0

    def _fill(self, columns: slice, rows: slice) -> Iterator[int]:
        """Fill one block. Yields the pairs that it has tried since it last did."""
        space, cone = self._space, self._cone
        column = np.arange(columns.start, min(columns.stop, space.columns), dtype=np.float32)
        row = np.arange(rows.start, min(rows.stop, space.rows), dtype=np.float32)
        x, y = np.meshgrid(
            space.left + (column + 0.5) * CELL, space.bottom + (row + 0.5) * CELL, indexing="ij", copy=False
        )
        nearest, normal = yield from self._cast(x.ravel().astype(np.float32), y.ravel().astype(np.float32))
        offsets = range(-_steps(cone.half_cone), _steps(cone.half_cone) + 1)
        axis = np.arange(HEADINGS, dtype=np.float32) * np.float32(math.tau / HEADINGS)
        heard = np.full((x.size, HEADINGS), np.inf, np.float32)
        met = np.zeros((x.size, HEADINGS), bool)
        for offset in offsets:
            distance = np.roll(nearest, -offset, axis=1)[:, ::2]
            faces = np.abs(np.cos(axis - np.roll(normal, -offset, axis=1)[:, ::2])) >= math.cos(cone.incidence)
            met |= distance < cone.reach
            np.minimum(heard, np.where(faces, distance, np.inf), out=heard)
        found = np.where(heard < cone.reach, heard / self.bin, np.where(met, SLANTED, CLEAR)).astype(np.uint8)
        self._table[columns, rows] = found.reshape(len(column), len(row), HEADINGS)
        yield found.size * len(offsets)

    def _cast(self, x: _Floats, y: _Floats) -> Generator[int, None, tuple[_Floats, _Floats]]:
        """Return m to the first wall and rad of its normal, of rays all around each of these places.

        Yields like `_fill`.
        """
        angles = np.arange(_RAYS, dtype=np.float32) * np.float32(_RAY)
        ray_x, ray_y = np.cos(angles), np.sin(angles)
        nearest = np.full((x.size, _RAYS), self._cone.reach, np.float32)
        normal = np.zeros((x.size, _RAYS), np.float32)
        yield _PER_WALL * len(self._walls)
        for wall, away, rays in _in_reach(self._walls, x, y, self._cone.reach):
            before = nearest[:, rays]
            yield before.size + _PER_TRIED_WALL
            if away > before.max():
                continue  # all that these rays can meet is nearer
            x0, y0, x1, y1 = wall
            along_x, along_y = x1 - x0, y1 - y0
            across = ray_x[rays] * along_y - ray_y[rays] * along_x
            across[np.abs(across) < 1e-7] = 1e-7
            to_x, to_y = x0 - x, y0 - y
            distance = (to_x * along_y - to_y * along_x)[:, None] / across
            part = (to_x[:, None] * ray_y[rays] - to_y[:, None] * ray_x[rays]) / across
            hit = (part >= 0.0) & (part <= 1.0) & (distance >= 0.0) & (distance < before)
            nearest[:, rays] = np.where(hit, distance, before)
            normal[:, rays] = np.where(hit, np.float32(math.atan2(along_x, -along_y)), normal[:, rays])
        return nearest, normal


def _in_reach(
    walls: _Floats, x: _Floats, y: _Floats, reach: float
) -> Iterator[tuple[_Floats, float, npt.NDArray[np.int64]]]:
    """Walls that may be met from these places, nearest first: m that they are away at least, and by which rays."""
    middle_x, middle_y = float(x.mean()), float(y.mean())
    x0, y0, x1, y1 = walls.T
    along_x, along_y = x1 - x0, y1 - y0
    squared = np.maximum(along_x**2 + along_y**2, 1e-12)
    part = np.clip(((middle_x - x0) * along_x + (middle_y - y0) * along_y) / squared, 0.0, 1.0)
    away = np.hypot(x0 + part * along_x - middle_x, y0 + part * along_y - middle_y)
    away -= np.hypot(x - middle_x, y - middle_y).max()
    near = np.argsort(away)[: np.count_nonzero(away < reach)]
    for some in np.split(near, range(_AT_ONCE, len(near), _AT_ONCE)):
        for wall, rays in zip(some, _rays(walls[some], x, y), strict=True):
            yield walls[wall], float(away[wall]), rays


def _rays(walls: _Floats, x: _Floats, y: _Floats) -> Iterator[npt.NDArray[np.int64]]:
    """Yield the rays by which each wall may be met from these places."""
    middle_x, middle_y = float(x.mean()), float(y.mean())
    x0, y0, x1, y1 = walls.T
    towards = np.arctan2((y0 + y1) / 2.0 - middle_y, (x0 + x1) / 2.0 - middle_x)
    one, other = (
        np.remainder(np.arctan2(end_y - y[:, None], end_x - x[:, None]) - towards + math.pi, math.tau) - math.pi
        for end_x, end_y in ((x0, y0), (x1, y1))
    )
    is_among = np.abs(one - other).max(0) > math.pi  # the wall lies among these places
    first = np.floor((towards + np.minimum(one, other).min(0)) / _RAY).astype(int)
    last = np.ceil((towards + np.maximum(one, other).max(0)) / _RAY).astype(int)
    counts = np.where(is_among, _RAYS, np.minimum(_RAYS, last - first + 1))
    for begin, count in zip(first, counts, strict=True):
        yield np.arange(begin, begin + count) % _RAYS


def _steps(half_cone: float) -> int:
    """Rays beside the axis."""
    return max(1, round(half_cone / _RAY))


def _grown(free: npt.NDArray[np.bool_], by: int) -> npt.NDArray[np.bool_]:
    """And what is within so many cells of it, along either axis."""
    grown = free.copy()
    for axis in (0, 1):
        total = np.cumsum(np.concatenate([np.zeros_like(grown.take([0], axis), int), grown.astype(int)], axis), axis)
        size = grown.shape[axis]
        at = np.arange(size)
        grown = total.take(np.minimum(at + by + 1, size), axis) > total.take(np.maximum(at - by, 0), axis)
    return grown
