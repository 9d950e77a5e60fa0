"""Ways over cells: the cheapest one, and the narrowest cell of the widest one. Plain heaps: numpy is slower here."""

import heapq
import math
from collections.abc import Iterator
from typing import Final

import numpy as np
import numpy.typing as npt

Costs = npt.NDArray[np.float64]
Cell = tuple[int, int]

_DIAGONAL: Final = 2.0**0.5
_AROUND: Final = tuple((i, j, math.hypot(i, j)) for i in (-1, 0, 1) for j in (-1, 0, 1) if i or j)


def cheapest(start: Cell, goal: Cell, weights: Costs) -> list[Cell] | None:
    """Return the cells of the cheapest way, both ends with it; None: there is none.

    `weights`: cost of a side's length in each cell, 1 at least; inf: no way goes there. A step costs the mean of both
    its cells. A* (Hart, Nilsson, Raphael 1968), by the length that is left on a floor without walls.
    """
    cost_of = weights.tolist()
    costs, before, done = {start: 0.0}, {start: start}, set[Cell]()
    heap = [(0.0, start)]
    while heap:
        _, here = heapq.heappop(heap)
        if here == goal:
            way = [goal]
            while way[-1] != start:
                way.append(before[way[-1]])
            return way[::-1]
        if here in done:
            continue
        done.add(here)
        cost, weight = costs[here], cost_of[here[0]][here[1]] / 2.0
        for cell, length in _beside(here, weights.shape):
            there = cost + (weight + cost_of[cell[0]][cell[1]] / 2.0) * length
            if there < costs.get(cell, math.inf):
                costs[cell], before[cell] = there, here
                heapq.heappush(heap, (there + _left(cell, goal), cell))
    return None


def narrowest(start: Cell, goal: Cell, room: Costs) -> Cell | None:
    """Return the cell with the least room on the widest way; None: there is none. `room`: -inf where no way goes."""
    rooms = room.tolist()
    seen, gap = {start}, start
    heap = [(-rooms[start[0]][start[1]], start)]
    while heap:
        # The cells come in the order of a flood that always takes the widest next. The least of them, and of equals the
        # last, is a gap that no way to the goal avoids.
        _, here = heapq.heappop(heap)
        if rooms[here[0]][here[1]] <= rooms[gap[0]][gap[1]]:
            gap = here
        if here == goal:
            return gap
        for cell, _ in _beside(here, room.shape):
            if cell not in seen and rooms[cell[0]][cell[1]] > -math.inf:
                seen.add(cell)
                heapq.heappush(heap, (-rooms[cell[0]][cell[1]], cell))
    return None


def _beside(cell: Cell, shape: tuple[int, ...]) -> Iterator[tuple[Cell, float]]:
    """Yield the cells around one, and how far away they are, in sides of a cell."""
    column, row = cell
    for right, up, length in _AROUND:
        if 0 <= column + right < shape[0] and 0 <= row + up < shape[1]:
            yield (column + right, row + up), length


def _left(cell: Cell, goal: Cell) -> float:
    across, up = abs(cell[0] - goal[0]), abs(cell[1] - goal[1])
    return max(across, up) + (_DIAGONAL - 1.0) * min(across, up)
