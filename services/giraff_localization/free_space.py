"""Where on a floor plan a robot can be."""

import math
from typing import Final

import numpy as np
import numpy.typing as npt

from giraff_maps.floor_plan import FloorPlan, Wall
from giraff_schemas.localization import FreeCells

Floats = npt.NDArray[np.float32]

CELL: Final = 0.05
"""m, of each side."""
_RIM: Final = 10
"""Cells around the plan, which lie outside for certain."""


class FreeSpace:
    """Cells over the plan and a rim around it."""

    def __init__(self, plan: FloorPlan, radius: float) -> None:
        """`radius`: m that the robot's middle keeps from every wall."""
        bounds = plan.bounds
        self.left, self.bottom = bounds.left - _RIM * CELL, bounds.bottom - _RIM * CELL
        """m, of the first cell's corner."""
        self.columns = math.ceil((bounds.right - self.left) / CELL) + _RIM
        self.rows = math.ceil((bounds.top - self.bottom) / CELL) + _RIM
        open_ = np.ones((self.columns, self.rows), bool)
        for wall in plan.walls:
            self._block(open_, wall, radius)
        outside = _reached(open_)
        within = open_.copy()
        within[:_RIM], within[-_RIM:], within[:, :_RIM], within[:, -_RIM:] = False, False, False, False
        inside = within & ~outside
        # A plan with a gap in its outer wall encloses next to nothing: then all of it counts.
        self.is_free = inside if 2 * inside.sum() > within.sum() else within
        self._cells = np.argwhere(self.is_free)
        plan_only = self.is_free[_RIM:-_RIM, _RIM:-_RIM]
        self.free = FreeCells(
            left=bounds.left,
            bottom=bounds.bottom,
            side=CELL,
            columns=plan_only.shape[0],
            rows=plan_only.shape[1],
            bits=np.packbits(plan_only).tobytes(),
        )
        """The same without the rim, for others."""

    @property
    def area(self) -> float:
        """m² of where the robot's middle can be."""
        return len(self._cells) * CELL * CELL

    def holds(self, x: Floats, y: Floats) -> npt.NDArray[np.bool_]:
        """Whether the robot's middle can be there."""
        # The outermost cells are never free, so that what is outside counts as one of them.
        free: npt.NDArray[np.bool_] = self.is_free[self.cells(x, y)]
        return free

    def cells(self, x: Floats, y: Floats) -> tuple[npt.NDArray[np.int32], npt.NDArray[np.int32]]:
        """Column and row of the cell at each place, or of the nearest."""
        column = np.minimum(np.maximum((x - self.left) * (1.0 / CELL), 0.0), self.columns - 1).astype(np.int32)
        return column, np.minimum(np.maximum((y - self.bottom) * (1.0 / CELL), 0.0), self.rows - 1).astype(np.int32)

    def anywhere(self, count: int, random: "np.random.Generator") -> Floats:
        """x, y, yaw of so many robots, each place and heading as likely as any other; shape (3, count)."""
        cells = self._cells[random.integers(len(self._cells), size=count)]
        places = (cells + random.random((count, 2))) * CELL
        yaw = random.uniform(-math.pi, math.pi, count)
        return np.array([places[:, 0] + self.left, places[:, 1] + self.bottom, yaw], np.float32)

    def places(self, apart: int) -> npt.NDArray[np.float64]:
        """Return x, y of the middles of free cells, so many cells apart along either axis; shape (n, 2)."""
        some = (self._cells % apart == apart // 2).all(axis=1)
        cells = self._cells[some] if some.any() else self._cells
        return np.array((cells + 0.5) * CELL + (self.left, self.bottom), np.float64)

    def _block(self, open_: npt.NDArray[np.bool_], wall: Wall, radius: float) -> None:
        """Take away what is nearer to the wall than `radius`."""
        x0, y0, x1, y1 = wall
        first_column = max(0, int((min(x0, x1) - radius - self.left) / CELL))
        first_row = max(0, int((min(y0, y1) - radius - self.bottom) / CELL))
        columns = np.arange(first_column, min(self.columns, int((max(x0, x1) + radius - self.left) / CELL) + 2))
        rows = np.arange(first_row, min(self.rows, int((max(y0, y1) + radius - self.bottom) / CELL) + 2))
        x = (self.left + (columns + 0.5) * CELL)[:, None]
        y = (self.bottom + (rows + 0.5) * CELL)[None, :]
        along_x, along_y = x1 - x0, y1 - y0
        squared = along_x**2 + along_y**2
        part = np.clip(((x - x0) * along_x + (y - y0) * along_y) / squared, 0.0, 1.0) if squared else 0.0
        near = np.hypot(x - x0 - part * along_x, y - y0 - part * along_y) <= radius
        open_[columns[0] : columns[-1] + 1, rows[0] : rows[-1] + 1] &= ~near


def _reached(open_: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
    """What can be reached from the corner."""
    columns, rows = open_.shape
    walled = np.zeros((columns + 2, rows + 2), bool)
    walled[1:-1, 1:-1] = open_
    flat, width = bytearray(walled.tobytes()), rows + 2
    stack = [width + 1]
    while stack:
        cell = stack.pop()
        if flat[cell] == 1:
            flat[cell] = 2
            stack += (cell + 1, cell - 1, cell + width, cell - width)
    reached: npt.NDArray[np.bool_] = np.frombuffer(flat, np.uint8).reshape(walled.shape)[1:-1, 1:-1] == 2
    return reached
