"""The cheapest way over cells, by numpy: all costs to the goal at once, lowered until none changes."""

from typing import Final

import numpy as np
import numpy.typing as npt

Costs = npt.NDArray[np.float64]
Cell = tuple[int, int]

_DIAGONAL: Final = 2.0**0.5
_BETWEEN_LOOKS: Final = 16
"""Sweeps between two looks whether any cost still changes."""
_AROUND: Final = tuple((column, row) for column in (-1, 0, 1) for row in (-1, 0, 1) if column or row)


def costs_to(goal: Cell, weights: Costs) -> Costs:
    """Return the cost of the cheapest way from each cell to the goal, in sides of a cell.

    `weights`: cost of a side's length in each cell; inf: no way goes there. A step costs the mean of both its cells.
    """
    rim = ((1, 1), (1, 1))
    half = np.pad(weights, rim, constant_values=np.inf) / 2.0
    far = half * _DIAGONAL
    costs = np.full(half.shape, np.inf)
    costs[goal[0] + 1, goal[1] + 1] = 0.0
    inner = costs[1:-1, 1:-1]
    while True:
        before = inner.copy()
        for _ in range(_BETWEEN_LOOKS):
            straight, diagonal = costs + half, costs + far
            beside = np.minimum(straight[:-2], straight[2:])[:, 1:-1]
            above = np.minimum(straight[:, :-2], straight[:, 2:])[1:-1]
            corners = np.minimum(diagonal[:-2], diagonal[2:])
            corners = np.minimum(corners[:, :-2], corners[:, 2:])
            np.minimum(beside, above, out=beside)
            np.minimum(inner, beside + half[1:-1, 1:-1], out=inner)
            np.minimum(inner, corners + far[1:-1, 1:-1], out=inner)
        if np.array_equal(before, inner):
            return inner


def widest_to(goal: Cell, room: Costs) -> Costs:
    """Return, for each cell, the room in the narrowest cell of the widest way to the goal. -inf: there is no way."""
    columns, rows = room.shape
    widest = np.full((columns + 2, rows + 2), -np.inf)
    widest[goal[0] + 1, goal[1] + 1] = room[goal]
    inner = widest[1:-1, 1:-1]
    while True:
        before = inner.copy()
        for _ in range(_BETWEEN_LOOKS):
            tall = np.maximum(np.maximum(widest[:-2], widest[1:-1]), widest[2:])
            around = np.maximum(np.maximum(tall[:, :-2], tall[:, 1:-1]), tall[:, 2:])
            np.maximum(inner, np.minimum(around, room), out=inner)
        if np.array_equal(before, inner):
            return inner


def descend(start: Cell, costs: Costs, weights: Costs) -> list[Cell]:
    """Return the cells of the cheapest way from `start` to where the cost is 0. The cost at the start is finite."""
    columns, rows = costs.shape
    way = [start]
    while costs[way[-1]] > 0.0:
        column, row = way[-1]
        beside = [
            (column + right, row + up)
            for right, up in _AROUND
            if 0 <= column + right < columns and 0 <= row + up < rows
        ]
        here = weights[column, row]
        way.append(
            min(
                beside,
                key=lambda cell: (
                    costs[cell]
                    + (here + weights[cell]) / 2.0 * (_DIAGONAL if cell[0] != column and cell[1] != row else 1.0)
                ),
            )
        )
    return way
