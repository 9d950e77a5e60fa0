"""Things that the robot's senses see now, and that are not on the floor plan. No I/O and no clock."""

import itertools
import math
from typing import Any, Final, NamedTuple

import numpy as np

from giraff_core.kinematics.pose import Pose
from giraff_core.robot import RobotConfig
from giraff_core.senses import Sense, Ultrasonic
from giraff_maps.floor_plan import Wall
from giraff_places.route.floor import Floor

KEPT: Final = 60.0
"""s for which a thing is kept in mind after it was seen."""
_CELL: Final = 0.1
"""m"""
_MOST: Final = 400
"""Cells that are told: the newest."""
_REACH: Final = 2.5
"""m from the robot. Beyond, an error of the heading moves an echo too far."""
_SAMPLES: Final = 3
"""Samples that must show it: one echo may be a wrong one."""
_OFF_PLAN: Final = {True: 0.25, False: 0.15}
"""m from every wall, so that a wall is not taken for a thing; of an ultrasonic sensor, and of others."""


class _Sighting(NamedTuple):
    at: float
    """s"""
    samples: int


class Things:
    """Cells of the floor in which something stands. Times are s of any one monotonic clock."""

    def __init__(self, robot: RobotConfig, floor: Floor) -> None:
        self._robot, self._floor = robot, floor
        self._cells: dict[tuple[int, int], _Sighting] = {}

    def on_sample(self, sample: Any, pose: Pose, now: float) -> None:
        """Take a sample of a sense, m, with the robot's pose in `map` as it was made."""
        if (sense := self._robot.sensors.get(sample.sensor)) is None:
            return
        for cell in self._found(sense, sample, pose):
            last = self._cells.pop(cell, None)
            seen_before = last.samples if last is not None and now - last.at <= KEPT else 0
            self._cells[cell] = _Sighting(now, seen_before + 1)
        while len(self._cells) > _MOST:
            del self._cells[next(iter(self._cells))]

    def walls(self, now: float, within: float = KEPT) -> list[Wall]:
        """Return what was seen in so many last s, for a planner."""
        points = self._points(now, within)
        return [(x, y, x, y) for x, y in points]

    def nearest(self, x: float, y: float, now: float) -> tuple[float, float] | None:
        """Return the thing that is nearest to a place of `map`, m; None: none is kept in mind."""
        return min(self._points(now, KEPT), key=lambda point: math.dist(point, (x, y)), default=None)

    def clear(self) -> None:
        """Forget them all: the robot is elsewhere than it was taken to be."""
        self._cells.clear()

    def _points(self, now: float, within: float) -> list[tuple[float, float]]:
        return [
            ((column + 0.5) * _CELL, (row + 0.5) * _CELL)
            for (column, row), seen in self._cells.items()
            if now - seen.at <= within and seen.samples >= _SAMPLES
        ]

    def _found(self, sense: Sense, sample: Any, pose: Pose) -> set[tuple[int, int]]:
        """Return the cells in which one sample shows something that is not on the plan."""
        strips = sense.evidence(sample, self._robot.footprint_radius).seen
        seen = np.array([point for strip in strips for point in _dense(strip)]).reshape(-1, 2)
        seen = seen[np.hypot(seen[:, 0], seen[:, 1]) <= _REACH]
        cos, sin = math.cos(pose.yaw), math.sin(pose.yaw)
        x, y = pose.x + cos * seen[:, 0] - sin * seen[:, 1], pose.y + sin * seen[:, 0] + cos * seen[:, 1]
        clearance = self._floor.at(x.astype(np.float32), y.astype(np.float32))
        is_new = clearance > _OFF_PLAN[isinstance(sense, Ultrasonic)]
        columns, rows = np.floor(x[is_new] / _CELL), np.floor(y[is_new] / _CELL)
        return {(int(column), int(row)) for column, row in zip(columns, rows, strict=True)}


def _dense(strip: Any) -> list[tuple[float, float]]:
    """Return places along a line, a cell apart or less."""
    places = [*strip[:1]]
    for (x, y), (end_x, end_y) in itertools.pairwise(strip):
        pieces = max(1, math.ceil(math.dist((x, y), (end_x, end_y)) / _CELL))
        shares = (piece / pieces for piece in range(1, pieces + 1))
        places += [(x + share * (end_x - x), y + share * (end_y - y)) for share in shares]
    return places
