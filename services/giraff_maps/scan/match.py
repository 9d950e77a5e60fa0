"""Finds the pose from which a turn of a laser scanner was taken, by the walls that other turns saw. No I/O, no clock.

Each point is drawn to the line through the nearest wall point (Gauss-Newton). A point that lies far off counts little,
and a wall is only matched with the same face of it.
"""

import math
from collections.abc import Sequence
from typing import Any, Final, NamedTuple, Protocol

import numpy as np
import numpy.typing as npt

CELL: Final = 0.04
"""m, of a field."""
_REACH: Final = 0.32  # m up to which a field knows the nearest wall point
_APART: Final = 0.05
"""m between two points that a field keeps. The first one of a place stays: walls that were drawn once do not drift."""
_HALF_SPAN: Final = 0.12  # m to either side, over which a wall's direction is taken
_ROUGH: Final = 0.022  # m: standard deviation beyond which points are no flat wall
_SHORT, _LONG = 0.02, 0.35
"""m. Standard deviation along a wall: a shorter one tells no direction, and a longer one has a gap."""
_SIGMA: Final = 0.02  # m: standard deviation of a point off its wall
_DEPENDENT: Final = 0.25  # weight of a point: neighbours err alike
_ON_WALL: Final = 0.06  # m off a wall within which a point lies on it
_ROUNDS: Final = 15
SAME_FACE: Final = 0.7
"""Cosine between two normals above which they are of one face of a wall."""

Floats = npt.NDArray[np.float64]


class Cloud(NamedTuple):
    """Points of one turn, and the walls' unit normals there, towards the scanner; (0, 0) where no flat wall is."""

    points: Floats
    normals: Floats

    def placed(self, pose: Any) -> "Cloud":
        """Return it in the frame in which the scanner has this pose (m, m, rad)."""
        return Cloud(rotated(pose[2], self.points) + np.asarray(pose[:2]), rotated(pose[2], self.normals))


class Matched(NamedTuple):
    """The pose of a turn."""

    pose: Floats
    share: float
    """Share of the points on flat walls that lie on the field's walls."""
    information: Floats
    """Inverse covariance of the pose (3 x 3; m, m, rad) by the walls alone, without the guess."""

    @property
    def slide(self) -> float:
        """m, standard deviation along the direction that the walls fix least: large in a smooth corridor."""
        return 1.0 / math.sqrt(max(1e-9, float(np.linalg.eigvalsh(self.information[:2, :2])[0])))


def rotated(angle: float, points: Any) -> Floats:
    """Return these points, rotated by so many rad about the origin."""
    cos, sin = math.cos(angle), math.sin(angle)
    turned: Floats = points @ np.array([[cos, sin], [-sin, cos]])
    return turned


def points_of(angles: Floats, ranges: Floats) -> Floats:
    """Return the points of rays that have these angles (rad) and ranges (m)."""
    points: Floats = ranges[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return points


def cloud_of(angles: Floats, ranges: Floats) -> Cloud:
    """Return the points and normals of a turn."""
    angles = angles % math.tau
    order = np.argsort(angles)
    angles, ranges = angles[order], ranges[order]
    half = np.clip(_HALF_SPAN / np.maximum(ranges, 0.1) * len(angles) / math.tau, 3, min(12, (len(angles) - 1) // 2))
    points = points_of(angles, ranges)
    return Cloud(points, _normals(points, half.astype(int)))


def _normals(points: Floats, half: npt.NDArray[np.int_]) -> Floats:
    """Fit a line to so many neighbours at either side of each point."""
    size, count = len(points), 2.0 * half + 1.0
    products = np.stack([*points.T, points[:, 0] ** 2, points[:, 0] * points[:, 1], points[:, 1] ** 2], axis=1)
    sums = np.concatenate([np.zeros((1, 5)), np.cumsum(np.concatenate([products] * 3), axis=0)])
    middle = size + np.arange(size)
    x, y, xx, xy, yy = ((sums[middle + half + 1] - sums[middle - half]) / count[:, None]).T
    xx, xy, yy = xx - x * x, xy - x * y, yy - y * y
    along = np.arctan2(2.0 * xy, xx - yy) / 2.0
    normals = np.stack([-np.sin(along), np.cos(along)], axis=1)
    mean, differs = (xx + yy) / 2.0, np.hypot((xx - yy) / 2.0, xy)
    long, rough = np.sqrt(np.maximum(mean + differs, 0.0)), np.sqrt(np.maximum(mean - differs, 0.0))
    is_wall = (rough < _ROUGH) & (long > _SHORT) & (long < _LONG) & (rough < long / 2.0)
    towards = -np.sign((normals * points).sum(axis=1))
    normals *= (is_wall * towards)[:, None]
    return normals


class Faces(Protocol):
    """Walls that a turn is matched with."""

    def alike(self, points: Floats, normals: Floats) -> tuple[Floats, Floats, npt.NDArray[np.bool_]]: ...


class Field:
    """The nearest wall point of each cell near a wall."""

    def __init__(self, clouds: Sequence[Cloud]) -> None:
        """`clouds`: in one frame."""
        points, normals = (np.concatenate(each) for each in zip(*clouds, strict=True))
        flat = (normals != 0.0).any(axis=1)
        points, normals = points[flat], normals[flat]
        is_empty = not len(points)
        if is_empty:
            points = normals = np.zeros((1, 2))
        faces = np.floor(np.arctan2(normals[:, 1], normals[:, 0]) / (math.pi / 2.0)).astype(np.int64)
        _, kept = np.unique(np.floor(points / _APART).astype(np.int64) @ (4_000_037, 4) + faces, return_index=True)
        self._points, self._normals = points[kept], normals[kept]
        self._low = np.floor(self._points.min(axis=0) / CELL) * CELL - 2.0 * _REACH
        self._shape = np.ceil((self._points.max(axis=0) + 2.0 * _REACH - self._low) / CELL).astype(int)
        self._nearest = np.full(int(self._shape.prod()), -1, dtype=np.int32)
        at, numbers = self._flat(self._points), np.arange(len(self._points), dtype=np.int32)
        reach = np.arange(-round(_REACH / CELL), round(_REACH / CELL) + 1)
        around = np.stack(np.meshgrid(reach, reach), axis=-1).reshape(-1, 2)
        far = (around**2).sum(axis=1)
        if is_empty:
            return
        for across, along in around[np.argsort(-far, kind="stable")]:  # the nearest one is painted last
            self._nearest[at + across * self._shape[1] + along] = numbers

    def nearest(self, points: Floats) -> tuple[Floats, Floats, npt.NDArray[np.bool_]]:
        """Return the nearest wall point of each, its normal, and whether there is one."""
        inside = ((points >= self._low) & (points < self._low + (self._shape - 1) * CELL)).all(axis=1)
        found = np.full(len(points), -1)
        found[inside] = self._nearest[self._flat(points[inside])]
        return self._points[found], self._normals[found], found >= 0

    def alike(self, points: Floats, normals: Floats) -> tuple[Floats, Floats, npt.NDArray[np.bool_]]:
        """Return the nearest wall point of each, its normal, and whether there is one whose face is the same.

        A point that lies on no flat wall, whose normal is (0, 0), is like any face.
        """
        at, found, known = self.nearest(points)
        is_alike = ((normals * found).sum(axis=1) > SAME_FACE) | (normals == 0.0).all(axis=1)
        return at, found, known & is_alike

    def cells(self, points: Floats) -> npt.NDArray[np.int64]:
        """Return column and row of the cell of each point: shape (n, 2)."""
        found: npt.NDArray[np.int64] = np.floor((points - self._low) / CELL).astype(np.int64)
        return found

    def likelihood(self, sigma: float, rim: int = 0) -> npt.NDArray[np.float32]:
        """Return by column and row 1 on a wall, falling with the distance, of standard deviation `sigma` m.

        `rim`: cells round about where it is 0, at each side twice as many.
        """
        found = np.zeros(len(self._nearest), np.float32)
        near = np.flatnonzero(self._nearest >= 0)
        middles = (np.stack(np.divmod(near, self._shape[1]), axis=1) + 0.5) * CELL + self._low
        squared = ((middles - self._points[self._nearest[near]]) ** 2).sum(axis=1)
        found[near] = np.exp(-squared / (2.0 * sigma**2))
        return np.pad(found.reshape(self._shape), 2 * rim)

    def _flat(self, points: Floats) -> Any:
        column, row = self.cells(points).T
        return column * self._shape[1] + row


def match(field: Faces, cloud: Cloud, guess: Any, spread: Sequence[float]) -> Matched:
    """Return the scanner's pose in the field. `spread`: standard deviations (m, m, rad) of `guess`."""
    pose, prior, gate = np.array(guess, dtype=float), 1.0 / np.square(spread), 0.3
    flat = (cloud.normals != 0.0).any(axis=1)
    off, walls = np.full(len(cloud.points), math.inf), np.zeros((3, 3))
    for number in range(_ROUNDS):
        points, own = cloud.placed(pose)
        at, normals, known = field.alike(points, own)
        off = np.where(known, (normals * (points - at)).sum(axis=1), math.inf)
        used = np.abs(off) < gate
        arm, normal, error = points[used] - pose[:2], normals[used], off[used]
        slope = np.column_stack([normal, normal[:, 1] * arm[:, 0] - normal[:, 0] * arm[:, 1]])
        weight = _DEPENDENT / (_SIGMA**2 + (error / 2.0) ** 2)
        weighed = (slope * weight[:, None]).T
        walls = weighed @ slope
        moved = pose - guess
        moved[2] = math.remainder(moved[2], math.tau)
        step = np.linalg.solve(walls + np.diag(prior), -weighed @ error - prior * moved)
        pose, gate = pose + step, max(0.1, gate * 0.75)
        if number > 3 and np.abs(step).max() < 2e-4:
            break
    share = int((np.abs(off[flat]) < _ON_WALL).sum()) / max(1, int(flat.sum()))
    return Matched(pose, share, walls)
