"""Straight walls through what the key turns saw, and how many of them were drawn twice."""

import math
from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

from giraff_maps.floor_plan import Wall
from giraff_maps.scan.mapper import KeyTurn
from giraff_maps.scan.match import Floats
from giraff_maps.scan.occupancy import OCCUPIED, OccupancyGrid

_LEAST: Final = 0.30  # m: a shorter wall is not drawn
_FEWEST: Final = 5  # points of a wall
_SEEDS: Final = 40  # points from which a wall is tried each time
_NEAR: Final = 0.05  # m off a wall up to which a point belongs to it
_TAKEN: Final = 0.03  # m more, up to which it is not used again
_GAP: Final = 0.15  # m between two points over which no wall goes on
_APART: Final = 0.02  # m between two points that are kept
_FACES: Final = 24
_DOUBLE_FACES: Final = 16
_BEHIND: Final = (0.10, 0.15, 0.20, 0.25, 0.30)  # m behind a wall, where the same wall may have been drawn again


class Faces(NamedTuple):
    """Points on flat walls, and the unit normals there towards who saw them: (n, 2)."""

    points: Floats
    normals: Floats


def faces_of(keys: Sequence[KeyTurn], grid: OccupancyGrid) -> Faces:
    """Return the points in occupied cells: one for each 2 cm and face that at least two points are of."""
    clouds = [key.turn.cloud.placed(key.pose) for key in keys]
    points, normals = (np.concatenate(each) for each in zip(*clouds, strict=True))
    kept = (normals != 0.0).any(axis=1) & (grid.state.reshape(-1)[grid.flat(points)] == OCCUPIED)
    points, normals = points[kept], normals[kept]
    cells = np.floor(points / _APART).astype(np.int64) @ (4_000_037, _FACES) + _face(normals, _FACES)
    _, first, count = np.unique(cells, return_index=True, return_counts=True)
    return Faces(points[first[count >= 2]], normals[first[count >= 2]])


class WallFinder:
    """Draws straight walls through faces, the longest first."""

    def __init__(self, faces: Faces) -> None:
        self._points, self._normals = faces
        self._left = np.ones(len(faces.points), bool)
        self.walls: list[Wall] = []
        """Each with the side that was seen at its right, from its beginning to its end."""

    @property
    def done(self) -> float:
        """Share of the points that were looked at, 0..1."""
        return 1.0 - float(self._left.mean()) if len(self._left) else 1.0

    def find(self) -> bool:
        """Draw a wall, or leave out a point that none goes through; return whether there may be more."""
        numbers = np.flatnonzero(self._left)
        if len(numbers) < _FEWEST:
            return False
        points, normals = self._points[numbers], self._normals[numbers]
        seed = _longest(points, normals)
        line = _Line(points[seed], normals[seed])
        if line.fit(points, normals) >= _FEWEST and line.end - line.begin >= _LEAST:
            self.walls.append(line.ends())
        self._left[numbers[line.takes(points, normals)]] = self._left[numbers[seed]] = False
        return True


def doubled(faces: Faces, grid: OccupancyGrid) -> float:
    """Return the share of wall cells with another wall 10 to 30 cm behind that faces the same way.

    A wall that was drawn twice is so: nobody sees a wall through the one before it.
    """
    cells = np.zeros((_DOUBLE_FACES, grid.state.size), bool)
    cells[_face(faces.normals, _DOUBLE_FACES), grid.flat(faces.points)] = True
    face, flat = np.nonzero(cells)
    if not len(face):
        return 0.0
    middles = (np.stack(np.divmod(flat, grid.state.shape[1]), axis=1) + 0.5) * grid.cell + grid.low
    angle = face * (math.tau / _DOUBLE_FACES)
    towards, found = np.stack([np.cos(angle), np.sin(angle)], axis=1), np.zeros(len(face), bool)
    thick = ~cells[face, grid.flat(middles - towards * grid.cell)]
    for behind in _BEHIND:
        at = middles - towards * behind
        inside = ((at > grid.low) & (at < grid.low + np.array(grid.state.shape) * grid.cell)).all(axis=1)
        found |= inside & thick & cells[face, np.where(inside, grid.flat(at), 0)]
    return float(found.mean())


def _face(normals: Floats, faces: int) -> npt.NDArray[np.int64]:
    """Return the number of the direction that each faces."""
    numbers: npt.NDArray[np.int64] = np.round(np.arctan2(normals[:, 1], normals[:, 0]) * (faces / math.tau)).astype(int)
    return numbers % faces


def _longest(points: Floats, normals: Floats) -> int:
    """Return the point through which the longest unbroken line goes, of some that are tried."""
    best, longest = 0, -1.0
    for seed in np.linspace(0, len(points) - 1, _SEEDS).astype(int):
        line = _Line(points[seed], normals[seed])
        line.stretch(points[line.near(points, normals, 0.03, 0.9)])
        if line.end - line.begin > longest:
            best, longest = int(seed), line.end - line.begin
    return best


class _Line:
    """A line through a point, and the unbroken stretch of it about that point."""

    def __init__(self, at: Floats, normal: Floats) -> None:
        self._at, self._normal = at, normal
        self.begin = self.end = 0.0
        """m along the line."""

    @property
    def _along(self) -> Floats:
        return np.array([-self._normal[1], self._normal[0]])

    def near(self, points: Floats, normals: Floats, metres: float, alike: float) -> npt.NDArray[np.bool_]:
        """Return which points lie on the line and face as it does: `alike`, cosine between the normals."""
        found: npt.NDArray[np.bool_] = (np.abs((points - self._at) @ self._normal) < metres) & (
            normals @ self._normal > alike
        )
        return found

    def stretch(self, points: Floats) -> None:
        """Take for the ends those of the points about its own one between which no gap is."""
        along = np.sort((points - self._at) @ self._along)
        if not len(along):
            self.begin = self.end = 0.0
            return
        cut = np.flatnonzero(np.diff(along) > _GAP)
        begins, ends = np.concatenate([along[:1], along[cut + 1]]), np.concatenate([along[cut], along[-1:]])
        nearest = int(np.maximum(begins, -ends).argmin())
        self.begin, self.end = float(begins[nearest]), float(ends[nearest])

    def fit(self, points: Floats, normals: Floats) -> int:
        """Lay it through the points near it; return how many these are."""
        count = 0
        for _ in range(4):
            on = points[self.near(points, normals, _NEAR, 0.85)]
            if len(on) >= _FEWEST:
                self.stretch(on)
            along = (on - self._at) @ self._along
            on = on[(along >= self.begin) & (along <= self.end)]
            count = len(on)
            if count < _FEWEST:
                break
            middle, along_before = on.mean(axis=0), self._along
            across = np.linalg.svd(on - middle, full_matrices=False)[2][1]
            moved = float((middle - self._at) @ along_before)
            self._at, self._normal = middle, across * np.sign(across @ self._normal)
            self.begin, self.end = self.begin - moved, self.end - moved
        return count

    def takes(self, points: Floats, normals: Floats) -> npt.NDArray[np.bool_]:
        """Return which points belong to it, and make no other wall."""
        along = (points - self._at) @ self._along
        within = (along >= self.begin - _TAKEN) & (along <= self.end + _TAKEN)
        taken: npt.NDArray[np.bool_] = within & self.near(points, normals, _NEAR + _TAKEN, 0.7)
        return taken

    def ends(self) -> Wall:
        (x0, y0), (x1, y1) = (self._at + self._along * along for along in (self.begin, self.end))
        return float(x0), float(y0), float(x1), float(y1)
