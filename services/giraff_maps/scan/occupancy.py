"""An occupancy grid of what the key turns saw: where something stands, where nothing does, and what nobody saw."""

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

from giraff_core.kinematics.pose import Pose
from giraff_maps.scan.mapper import KeyTurn
from giraff_maps.scan.match import Floats

UNKNOWN, FREE, OCCUPIED = -1, 0, 1
CELL: Final = 0.05  # m
_FAR: Final = 8.0  # m up to which a ray tells that nothing is there
_NEAR: Final = 0.15  # m from the scanner from which on it does
_RIM: Final = 3  # cells about all
_HITS: Final = 2
"""Key turns that must have seen something in a cell."""
_SHARE: Final = 0.35  # of the key turns that looked: a person leaves few hits where many saw through


class OccupancyGrid(NamedTuple):
    """Cells of a floor."""

    state: npt.NDArray[np.int8]
    """By column (along x) and row (along y): UNKNOWN, FREE or OCCUPIED."""
    low: Floats
    """m; left and lower corner."""
    cell: float
    """m; side of a cell."""

    def flat(self, points: Floats) -> npt.NDArray[np.int64]:
        """Return the numbers of the cells of points (n, 2), in the order of `state.ravel()`."""
        column, row = np.floor((points - self.low) / self.cell).astype(np.int64).T
        numbers: npt.NDArray[np.int64] = column * self.state.shape[1] + row
        return numbers


class Looks:
    """Counts in which cells something was seen, and through which."""

    def __init__(self, keys: Sequence[KeyTurn], mount: Pose) -> None:
        """`keys`: all that are looked at. `mount`: of the scanner."""
        self._mount = mount
        seen = [key.turn.cloud.placed(key.pose).points for key in keys]
        points = np.concatenate([*seen, [mount.placed_in(key.pose)[:2] for key in keys]])
        low = np.floor(points.min(axis=0) / CELL - _RIM) * CELL
        size = np.ceil((points.max(axis=0) - low) / CELL).astype(int) + _RIM + 1
        self._grid = OccupancyGrid(np.full(size, UNKNOWN, np.int8), low, CELL)
        self._hits, self._passed = np.zeros((2, self._grid.state.size), np.int32)
        self._steps = np.arange(_NEAR, _FAR, CELL * 0.7)

    def add(self, key: KeyTurn) -> None:
        """Count what one of them saw."""
        points, scanner = key.turn.cloud.placed(key.pose).points, np.array(self._mount.placed_in(key.pose)[:2])
        ranges = np.hypot(*(points - scanner).T)
        directions = (points - scanner) / ranges[:, None]
        ray, step = np.nonzero(self._steps < np.minimum(ranges, _FAR)[:, None] - 0.75 * CELL)
        self._passed[np.unique(self._grid.flat(scanner + directions[ray] * self._steps[step, None]))] += 1
        self._hits[np.unique(self._grid.flat(points))] += 1

    def grid(self) -> OccupancyGrid:
        """Return what that tells."""
        looked, state = self._hits + self._passed, self._grid.state.reshape(-1)
        state[(looked > 0) & (self._hits < _SHARE * looked)] = FREE
        state[(self._hits >= _HITS) & (self._hits >= _SHARE * looked)] = OCCUPIED
        return self._grid
