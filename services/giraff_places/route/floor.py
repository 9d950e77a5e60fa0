"""Clearance on a floor plan: how far each spot of the floor is from the nearest wall."""

import math
from collections.abc import Iterable
from typing import Final

import numpy as np
import numpy.typing as npt

from giraff_maps.floor_plan import Bounds, FloorPlan, Wall

Floats = npt.NDArray[np.float32]
Cells = npt.NDArray[np.intp]

CELL: Final = 0.1
"""m. Side of the cells that a route goes by."""
_PARTS: Final = 4
"""Spots along each side of a cell. A door is judged by the best of them, to about 2 cm."""
SPOT: Final = CELL / _PARTS
"""m between spots."""
_EDGE: Final = 0.002
"""m beyond the edge that counts as on it: single precision, 10 km from (0, 0)."""


class Floor:
    """Clearance of spots over the rectangle about a plan."""

    def __init__(self, bounds: Bounds, far: float, spots: Floats) -> None:
        """`far`: m. Largest clearance that is told."""
        self._bounds, self._far = bounds, far
        self._spots = spots
        columns, rows = (count // _PARTS for count in spots.shape)
        parts = spots.reshape(columns, _PARTS, rows, _PARTS).swapaxes(1, 2).reshape(columns, rows, _PARTS * _PARTS)
        self._best = parts.argmax(axis=2)
        self.clearance: Floats = np.take_along_axis(parts, self._best[..., None], axis=2)[..., 0]
        """m. Clearance at the best spot of each cell; shape (columns, rows)."""

    @classmethod
    def of(cls, plan: FloorPlan, far: float) -> "Floor":
        """Return the floor of a plan. `far`: m. Largest clearance that is told."""
        left, bottom, right, top = plan.bounds
        columns = max(1, math.ceil((right - left) / CELL - 1e-6))
        rows = max(1, math.ceil((top - bottom) / CELL - 1e-6))
        floor = cls(plan.bounds, far, np.full((columns * _PARTS, rows * _PARTS), far, np.float32))
        return floor.with_walls(plan.walls)

    def with_walls(self, walls: Iterable[Wall]) -> "Floor":
        """Return the same floor with more that a route keeps from."""
        spots = self._spots.copy()
        for wall in walls:
            self._lower(spots, wall)
        return Floor(self._bounds, self._far, spots)

    def at(self, x: Floats, y: Floats) -> Floats:
        """Return the clearance at places of `map`, m; 0 off the plan."""
        left, bottom, right, top = self._bounds
        column = np.floor((x - left) / SPOT).astype(np.intp)
        row = np.floor((y - bottom) / SPOT).astype(np.intp)
        columns, rows = self._spots.shape
        inside = (x >= left - _EDGE) & (x <= right + _EDGE) & (y >= bottom - _EDGE) & (y <= top + _EDGE)
        clearance = self._spots[np.clip(column, 0, columns - 1), np.clip(row, 0, rows - 1)]
        return np.where(inside, clearance, np.float32(0.0))

    def near(self, x: float, y: float) -> float:
        """Return the clearance at one place, m."""
        return float(self.at(np.array([x], np.float32), np.array([y], np.float32))[0])

    def cell(self, x: float, y: float) -> tuple[int, int]:
        """Return column and row of the cell at a place, or of the nearest."""
        columns, rows = self.clearance.shape
        column, row = math.floor((x - self._bounds.left) / CELL), math.floor((y - self._bounds.bottom) / CELL)
        return min(max(column, 0), columns - 1), min(max(row, 0), rows - 1)

    def middles(self) -> tuple[Floats, Floats]:
        """Return x of the columns' middles and y of the rows', m."""
        columns, rows = self.clearance.shape
        x = self._bounds.left + (np.arange(columns, dtype=np.float32) + 0.5) * CELL
        y = self._bounds.bottom + (np.arange(rows, dtype=np.float32) + 0.5) * CELL
        return x.astype(np.float32), y.astype(np.float32)

    def best_spots(self, cells: Cells) -> Floats:
        """Return x, y of the spots of cells that are farthest from walls; both have the shape (n, 2)."""
        part_column, part_row = np.divmod(self._best[cells[:, 0], cells[:, 1]], _PARTS)
        spots = cells * _PARTS + np.stack([part_column, part_row], axis=1) + 0.5
        places: Floats = (spots * SPOT + (self._bounds.left, self._bounds.bottom)).astype(np.float32)
        return places

    def _lower(self, spots: Floats, wall: Wall) -> None:
        """Lower the clearance about one wall."""
        x0, y0, x1, y1 = wall
        low = max(0, math.floor((min(x0, x1) - self._far - self._bounds.left) / SPOT))
        high = min(spots.shape[0], math.ceil((max(x0, x1) + self._far - self._bounds.left) / SPOT))
        bottom = max(0, math.floor((min(y0, y1) - self._far - self._bounds.bottom) / SPOT))
        top = min(spots.shape[1], math.ceil((max(y0, y1) + self._far - self._bounds.bottom) / SPOT))
        if low >= high or bottom >= top:
            return
        x = ((np.arange(low, high) + 0.5) * SPOT + (self._bounds.left - x0)).astype(np.float32)[:, None]
        y = ((np.arange(bottom, top) + 0.5) * SPOT + (self._bounds.bottom - y0)).astype(np.float32)[None, :]
        along_x, along_y = np.float32(x1 - x0), np.float32(y1 - y0)
        squared = along_x * along_x + along_y * along_y
        part = np.clip((x * along_x + y * along_y) / squared, 0.0, 1.0) if squared > 0.0 else np.float32(0.0)
        box = spots[low:high, bottom:top]
        np.minimum(box, np.hypot(x - part * along_x, y - part * along_y), out=box)
