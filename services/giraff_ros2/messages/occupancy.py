"""The floor plan as an occupancy grid of ROS.

`giraff map convert` fills a room from its start, which a plan on the network does not have. Here cells that can be
reached from the edge of the grid are unknown, and those that cannot are free.
"""

import math
from typing import TYPE_CHECKING, Final

import numpy as np
from rosbags.typesys.stores.ros2_kilted import geometry_msgs__msg__Point as Point
from rosbags.typesys.stores.ros2_kilted import geometry_msgs__msg__Pose as Pose
from rosbags.typesys.stores.ros2_kilted import nav_msgs__msg__MapMetaData as MapMetaData
from rosbags.typesys.stores.ros2_kilted import nav_msgs__msg__OccupancyGrid as OccupancyGrid

from giraff_ros2.messages.header import header, quaternion, stamp
from giraff_schemas.frames import MAP_FRAME
from giraff_schemas.localization import MapWalls

if TYPE_CHECKING:
    from numpy.typing import NDArray

_OCCUPIED, _FREE, _UNKNOWN = 100, 0, -1
_RESOLUTION: Final = 0.05
"""m. Side of a cell."""
_MOST_CELLS: Final = 250_000
"""Cells of the largest grid: 25 m by 25 m. A larger plan gets larger cells, so that the robot's turns stay short."""
_MARGIN: Final = 2  # cells about all
_STEP: Final = 0.25  # cells between two points of a wall that are drawn
_FARTHEST: Final = 10_000.0  # m; no home has a wall beyond it


def occupancy(walls: MapWalls, stamp_ns: int) -> OccupancyGrid:
    """Return the grid of a plan; without a wall it has no cells."""
    lines = np.array([wall for wall in walls.walls if max(map(abs, wall)) <= _FARTHEST]).reshape(-1, 2, 2)
    left, bottom, side = 0.0, 0.0, _RESOLUTION
    cells = np.zeros((0, 0), dtype=np.int8)
    if len(lines):
        (x, y), (right, top) = lines.min(axis=(0, 1)).tolist(), lines.max(axis=(0, 1)).tolist()
        while (width := _cells(x, right, side)) * (height := _cells(y, top, side)) > _MOST_CELLS:
            side *= 2.0
        # Whole cells from the map's origin are middles of cells, as in giraff_maps: plans have their walls there.
        left, bottom = ((round(low / side) - _MARGIN - 0.5) * side for low in (x, y))
        cells = _filled(_drawn((lines - (left, bottom)) / side, height, width))
    origin = Pose(Point(left, bottom, 0.0), quaternion(0.0, 0.0, 0.0))
    info = MapMetaData(stamp(stamp_ns), side, cells.shape[1], cells.shape[0], origin)
    return OccupancyGrid(header(stamp_ns, MAP_FRAME), info, cells.ravel())


def _cells(low: float, high: float, side: float) -> int:
    return round(high / side) - round(low / side) + 1 + 2 * _MARGIN


def _drawn(lines: "NDArray[np.float64]", height: int, width: int) -> "NDArray[np.bool_]":
    """Return the cells, the lowest row first, in which a wall is. `lines`: in cells."""
    is_wall = np.zeros((height, width), dtype=np.bool_)
    for begin, end in lines:
        steps = math.ceil(math.dist(begin, end) / _STEP) + 1
        at = np.floor(begin + np.linspace(0.0, 1.0, steps + 1)[:, None] * (end - begin)).astype(np.int64)
        is_wall[at[:, 1].clip(0, height - 1), at[:, 0].clip(0, width - 1)] = True
    return is_wall


def _filled(is_wall: "NDArray[np.bool_]") -> "NDArray[np.int8]":
    """Return occupied, free and unknown cells."""
    outside = np.zeros_like(is_wall)
    outside[0, :] = True  # no wall is there, by the margin
    before = 0
    while (found := int(outside.sum())) != before:  # as often as the way to the farthest place has corners
        before = found
        outside = _spread(outside, is_wall)
        outside = _spread(outside.T, is_wall.T).T
    return np.where(is_wall, _OCCUPIED, np.where(outside, _UNKNOWN, _FREE)).astype(np.int8)


def _spread(reached: "NDArray[np.bool_]", is_wall: "NDArray[np.bool_]") -> "NDArray[np.bool_]":
    """Return the cells with those added that are in one row with a reached one, and no wall between."""
    padded = np.pad(is_wall, ((0, 0), (0, 1)), constant_values=True)  # a run of cells ends at the row's end
    runs = np.cumsum(padded.ravel()).reshape(padded.shape)[:, :-1]
    counts = np.bincount(runs[reached], minlength=int(runs.max()) + 1)
    spread: NDArray[np.bool_] = (counts[runs] > 0) & ~is_wall
    return spread
