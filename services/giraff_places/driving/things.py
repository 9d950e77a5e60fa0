"""Things that the robot's senses see now, and that are not on the floor plan. No I/O and no clock."""

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
_CELL: Final = 0.05
"""m"""
_MOST: Final = 1500
"""Cells that are kept in mind: the newest."""
_SAMPLES: Final = 3
"""Samples that must show it soon after each other: one echo, or one ray at an edge, may be a wrong one."""
_SOON: Final = 0.6
"""s"""
_OFF_PLAN: Final = {True: 0.25, False: 0.15}
"""m from every wall, so that a wall is not taken for a thing; of an ultrasonic sensor, and of others."""
_REACH: Final = {True: 1.2, False: 2.5}
"""m from the robot. Beyond, a cone is too wide, and an error of the heading moves what was seen too far; as above."""
_NEAR: Final = 1.5
"""m around the robot in which what a scanner sees counts more than the plan, and for how long."""
_LATELY: Final = 10.0
"""s"""


class _Sighting(NamedTuple):
    at: float
    """s"""
    samples: int
    x: float
    """m, in `map`."""
    y: float
    is_new: bool
    """It is not on the plan."""
    is_exact: bool
    """It is off by little."""


class Things:
    """Cells of the floor in which something stands. Times are s of any one monotonic clock."""

    def __init__(self, robot: RobotConfig, floor: Floor) -> None:
        self._robot, self._floor = robot, floor
        self._cells: dict[tuple[int, int], _Sighting] = {}

    def on_sample(self, sample: Any, pose: Pose, now: float) -> None:
        """Take a sample of a sense, m, with the robot's pose in `map` as it was made."""
        if (sense := self._robot.sensors.get(sample.sensor)) is None:
            return
        for cell, (x, y, is_new) in self._found(sense, sample, pose).items():
            last = self._cells.pop(cell, None)
            samples = (
                1 if last is None or now - last.at > (_SOON if last.samples < _SAMPLES else KEPT) else last.samples + 1
            )
            self._cells[cell] = _Sighting(now, samples, x, y, is_new, not isinstance(sense, Ultrasonic))
        while len(self._cells) > _MOST:
            del self._cells[next(iter(self._cells))]

    def walls(self, now: float, within: float = KEPT) -> list[Wall]:
        """Return what was seen in so many last s and is not on the plan, for a planner."""
        return [(seen.x, seen.y, seen.x, seen.y) for seen in self._seen(now, within) if seen.is_new]

    def walls_near(self, pose: Pose, now: float) -> list[Wall]:
        """Return all that a scanner has seen lately near the robot, be it on the plan or not."""
        near = (seen for seen in self._seen(now, _LATELY) if math.dist((seen.x, seen.y), pose[:2]) <= _NEAR)
        return [(seen.x, seen.y, seen.x, seen.y) for seen in near if seen.is_exact]

    def nearest(self, x: float, y: float, now: float) -> tuple[float, float] | None:
        """Return the thing that is nearest to a place of `map`, m; None: none is kept in mind."""
        points = [(seen.x, seen.y) for seen in self._seen(now, KEPT) if seen.is_new]
        return min(points, key=lambda point: math.dist(point, (x, y)), default=None)

    def clear(self) -> None:
        """Forget them all: the robot is elsewhere than it was taken to be."""
        self._cells.clear()

    def _seen(self, now: float, within: float) -> list[_Sighting]:
        return [seen for seen in self._cells.values() if now - seen.at <= within and seen.samples >= _SAMPLES]

    def _found(self, sense: Sense, sample: Any, pose: Pose) -> dict[tuple[int, int], tuple[float, float, bool]]:
        """Return a place in each cell in which one sample shows something, and whether it is not on the plan."""
        strips = sense.evidence(sample, self._robot.footprint_radius).seen
        seen = np.array([point for strip in strips for point in strip]).reshape(-1, 2)
        is_cone = isinstance(sense, Ultrasonic)
        seen = seen[np.hypot(seen[:, 0], seen[:, 1]) <= _REACH[is_cone]]
        cos, sin = math.cos(pose.yaw), math.sin(pose.yaw)
        x, y = pose.x + cos * seen[:, 0] - sin * seen[:, 1], pose.y + sin * seen[:, 0] + cos * seen[:, 1]
        clearance = self._floor.at(x.astype(np.float32), y.astype(np.float32))
        is_new = clearance > _OFF_PLAN[is_cone]
        cells = np.floor(np.stack([x, y], axis=1) / _CELL).astype(int).tolist()
        places = zip(x.tolist(), y.tolist(), is_new.tolist(), strict=True)
        return {(column, row): place for (column, row), place in zip(cells, places, strict=True)}
