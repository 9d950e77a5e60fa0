"""Walls about the occupied cells of a grid.

Each blob of occupied cells gets an outline halfway to the cells beside it. Outlines follow the cells in steps, so they
are straightened by Douglas and Peucker: a slanted wall gets one long segment that faces where the wall does, on which
the sensor model depends. A wall as thin as a cell may become one line; it never vanishes.
"""

import itertools
import math
from typing import TYPE_CHECKING, Final

from giraff_maps.floor_plan import MOST_WALLS, MapError, Wall
from giraff_node.process.libraries import remedy

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from giraff_maps.grid_file import Grid

    Points = NDArray[np.float64]

_LEVEL: Final = 0.49  # just below the middle, so that cells that meet at a corner are one blob
_TOLERANCE: Final = 1.0  # cells between an outline and its straightened form
_SMALL: Final = 4.0  # cells; what is no longer keeps its shape
_SMALL_TOLERANCE: Final = 0.3  # cells; of these
_CORNERS: Final = 4  # of the least outline that is no line, with its first one twice
_MOVED: Final = 0.71  # cells; most by which a corner is moved
_PARALLEL: Final = 0.2  # sine of the least angle between two sides that are prolonged until they meet


def walls_of(grid: "Grid") -> list[Wall]:
    """m; in the map: no more than one outline beyond MOST_WALLS. Raises MapError where contourpy is missing."""
    walls: list[Wall] = []
    x, y, yaw = grid.origin
    cos, sin = math.cos(yaw) * grid.resolution, math.sin(yaw) * grid.resolution
    for outline in _outlines(grid.occupied):
        corners = [(x + cos * u - sin * v, y + sin * u + cos * v) for u, v in _straightened(outline).tolist()]
        pairs = itertools.pairwise(corners)
        walls += [(*begin, *end) for begin, end in pairs] if len(corners) != 3 else [(*corners[0], *corners[1])]
        if len(walls) > MOST_WALLS:
            break
    return walls


def _outlines(occupied: "NDArray[np.bool_]") -> "list[Points]":
    """Closed lines, in cells from the lower left corner of the first one: the last point is the first again."""
    import numpy as np  # noqa: PLC0415

    try:
        from contourpy import contour_generator  # noqa: PLC0415
    except ImportError as error:
        raise MapError(f"the library contourpy is missing; {remedy('localization')}") from error
    field = np.pad(occupied.astype(np.float32), 1)  # also what reaches the edge has an outline there
    found = contour_generator(z=field).lines(_LEVEL)
    return [np.asarray(line, dtype=np.float64) - 0.5 for line in found]


def _straightened(outline: "Points") -> "Points":
    """The same with as few points as its shape needs, closed as before.

    Of a thin blob three: there and back again.
    """
    import numpy as np  # noqa: PLC0415

    ring = outline[:-1]
    begin = int(np.argmax(_squares(ring - ring.mean(axis=0))))
    ring = np.roll(ring, -begin, axis=0)
    away = _squares(ring - ring[0])
    far = int(np.argmax(away))
    small = away[far] <= _SMALL**2
    tolerance = _SMALL_TOLERANCE if small else _TOLERANCE
    closed = np.vstack((ring, ring[:1]))
    kept = np.zeros(len(closed), dtype=np.bool_)
    kept[[0, far, len(ring)]] = True
    spans = [(0, far), (far, len(ring))]
    while spans:
        first, last = spans.pop()
        if last - first < 2:
            continue
        off = _off_line(closed[first + 1 : last], closed[first], closed[last])
        worst = int(np.argmax(off))
        if off[worst] > tolerance:
            middle = first + 1 + worst
            kept[middle] = True
            spans += [(first, middle), (middle, last)]
    return np.asarray(closed[kept]) if small else _fitted(closed, np.flatnonzero(kept))


def _fitted(closed: "Points", kept: "NDArray[np.intp]") -> "Points":
    """The corners of a straightened outline, each where the lines meet that fit its points best on either side."""
    import numpy as np  # noqa: PLC0415

    if len(kept) < _CORNERS:  # there and back again
        return np.asarray(closed[kept])
    lines = [_line(closed[first : last + 1]) for first, last in itertools.pairwise(kept.tolist())]
    corners = closed[kept[:-1]].copy()
    for number, corner in enumerate(corners):
        (one, normal), (other, other_normal) = lines[number - 1], lines[number]
        sides = np.array([normal, other_normal])
        if abs(np.linalg.det(sides)) > _PARALLEL:
            meet = np.linalg.solve(sides, [normal @ one, other_normal @ other])
            if _squares((meet - corner)[None])[0] < _MOVED**2:
                corners[number] = meet
    return np.vstack((corners, corners[:1]))


def _line(points: "Points") -> "tuple[Points, Points]":
    """A point and the unit normal of the line that fits points best, but for those at its ends, which corners cut."""
    import numpy as np  # noqa: PLC0415

    inner = points[1:-1] if len(points) > _CORNERS else points
    middle = inner.mean(axis=0)
    _, axes = np.linalg.eigh((inner - middle).T @ (inner - middle))
    return middle, np.asarray(axes[:, 0])  # along which they are spread least


def _squares(vectors: "Points") -> "Points":
    squares: Points = (vectors * vectors).sum(axis=1)
    return squares


def _off_line(points: "Points", begin: "Points", end: "Points") -> "Points":
    """Distances of points from the segment between two others."""
    import numpy as np  # noqa: PLC0415

    along = end - begin
    share = np.clip((points - begin) @ along / float(along @ along), 0.0, 1.0)
    return np.asarray(np.hypot(*(points - begin - share[:, None] * along).T))
