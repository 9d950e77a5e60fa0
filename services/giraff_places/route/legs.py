"""Straight legs in place of a way over cells."""

from collections.abc import Callable
from typing import Final

import numpy as np
import numpy.typing as npt

Points = npt.NDArray[np.float32]
Weigh = Callable[[Points, Points], npt.NDArray[np.float64]]

_TURN: Final = 0.6
"""m of way that a stop and a turn cost: about 2 s."""
_LONGEST: Final = 8.0
"""m of one leg. Beyond it, a heading that is off by a degree or two leads the robot aside."""
_APART: Final = 3
"""Cells between two places where legs may end."""
_STRAIGHT: Final = 0.005
"""rad that is no turn."""
_STEP: Final = 0.05
"""m between two looks along a leg."""


def straighten(points: Points, weigh: Weigh) -> Points:
    """Return the corners of the cheapest chain of legs that end at some of the points; shape (n, 2), m.

    `weigh`: cost of a metre at places x, y; inf: no leg goes there. Neighbouring points are always joined.
    """
    ends = np.unique(np.append(np.arange(0, len(points), _APART), len(points) - 1))
    some = points[ends]
    count = len(some)
    best = np.full(count, np.inf)
    best[0] = 0.0
    before = np.zeros(count, int)
    for i in range(count - 1):
        last = int(np.searchsorted(_walked(some[i:]), _LONGEST * 1.5)) + i
        later = np.arange(i + 1, max(i + 2, min(count, last + 1)))
        costs = best[i] + _TURN + _leg_costs(some[i], some[later], weigh)
        if not np.isfinite(costs[0]):  # the cells between two ends may turn a corner
            costs[0] = best[i] + _walk_cost(points[ends[i] : ends[i + 1] + 1], weigh)
        better = costs < best[later]
        best[later[better]] = costs[better]
        before[later[better]] = i
    chain = [count - 1]
    while chain[-1]:
        chain.append(int(before[chain[-1]]))
    corners: list[int] = []
    for begin, end in zip(chain[:0:-1], chain[-2::-1], strict=True):
        straight = np.isfinite(_leg_costs(some[begin], some[[end]], weigh))[0]
        corners += [int(ends[begin])] if straight else [*range(int(ends[begin]), int(ends[end]))]
    return _joined(points[[*corners, len(points) - 1]])


def _joined(corners: Points) -> Points:
    """Return the corners without those at which the way does not turn."""
    before, after = np.diff(corners, axis=0)[:-1], np.diff(corners, axis=0)[1:]
    off = np.abs(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0])
    turns = off > _STRAIGHT * np.hypot(*before.T) * np.hypot(*after.T)
    ahead = (before * after).sum(axis=1) > 0.0
    joined: Points = corners[np.concatenate([[True], turns | ~ahead, [True]])]
    return joined


def _walked(points: Points) -> npt.NDArray[np.float64]:
    """Return the straight distance of each point from the first, but never less than of one before it."""
    return np.maximum.accumulate(np.hypot(*(points - points[0]).T)).astype(np.float64)


def _leg_costs(start: Points, ends: Points, weigh: Weigh) -> npt.NDArray[np.float64]:
    """Return the cost of the straight leg to each end."""
    along = ends - start
    lengths = np.maximum(np.hypot(along[:, 0], along[:, 1]), 1e-6)
    count = max(2, int(lengths.max() / _STEP) + 2)
    part = np.linspace(0.0, 1.0, count, dtype=np.float32)
    x = start[0] + along[:, :1] * part
    y = start[1] + along[:, 1:] * part
    costs: npt.NDArray[np.float64] = weigh(x, y).mean(axis=1) * lengths
    costs[lengths > _LONGEST] = np.inf
    return costs


def _walk_cost(points: Points, weigh: Weigh) -> float:
    """Return the cost of going from point to point."""
    lengths = np.hypot(*np.diff(points, axis=0).T)
    weights = weigh(points[:, 0], points[:, 1])
    weights = np.where(np.isfinite(weights), weights, weights[np.isfinite(weights)].max(initial=1.0))
    return float((lengths * (weights[1:] + weights[:-1]) / 2.0).sum() + _TURN * len(lengths))
