"""The places around which particles gather."""

import math
from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

from giraff_core.kinematics.calibration import Covariance
from giraff_core.kinematics.pose import Pose
from giraff_localization.cloud import Cloud

_APART: Final = 1.0
"""m between two places that are not the same."""
_APART_YAW: Final = 0.7
"""rad; the same of two headings."""
_CELL: Final = 0.5
_HEADINGS: Final = 12
_MOST: Final = 3
_LEAST_MASS: Final = 0.02
_ENOUGH: Final = 4000
"""Particles, of more of which a place would not be known any better."""
_NARROWING: Final = (1.0, 0.8)
"""m around the middle, in turn."""


class Cluster(NamedTuple):
    """Particles about one place."""

    pose: Pose
    mass: float
    """Share of the weights."""
    spread: float
    """m, standard deviation over both axes."""
    covariance: Covariance

    def is_near(self, pose: Pose) -> bool:
        """Whether that is the same place."""
        return are_near(self.pose, pose)


def are_near(one: Pose, other: Pose) -> bool:
    """Whether two poses are the same place."""
    return math.dist(one[:2], other[:2]) < _APART and abs(math.remainder(one.yaw - other.yaw, math.tau)) < _APART_YAW


def clusters(cloud: Cloud) -> list[Cluster]:
    """The heaviest, heaviest first: where most weight is within two cells and two headings, and all around that."""
    x, y, yaw = cloud.sample(_ENOUGH)
    left, bottom = x.min(), y.min()
    columns, rows = int((x.max() - left) / _CELL) + 2, int((y.max() - bottom) / _CELL) + 2
    column, row = ((x - left) / _CELL).astype(np.int64), ((y - bottom) / _CELL).astype(np.int64)
    heading = (yaw % math.tau * (_HEADINGS / math.tau)).astype(np.int64) % _HEADINGS
    cells = (column * rows + row) * _HEADINGS + heading
    left_over = np.full(len(x), 1.0 / len(x))
    found: list[Cluster] = []
    for _ in range(_MOST):
        heap = np.bincount(cells, left_over, columns * rows * _HEADINGS).reshape(columns, rows, _HEADINGS)
        heap = heap + np.roll(heap, -1, 2)
        heap = heap[:-1] + heap[1:]
        heap = heap[:, :-1] + heap[:, 1:]
        top = np.unravel_index(heap.argmax(), heap.shape)
        middle_x, middle_y = left + (top[0] + 1) * _CELL, bottom + (top[1] + 1) * _CELL
        middle_yaw = (top[2] + 1) * math.tau / _HEADINGS
        near = np.zeros(len(x), bool)
        off = np.zeros((3, 0))
        share = np.zeros(0)
        mass = 0.0
        for radius in _NARROWING:
            aside = (yaw - middle_yaw + math.pi) % math.tau - math.pi
            near = (np.hypot(x - middle_x, y - middle_y) < radius) & (np.abs(aside) < _APART_YAW)
            mass = float(left_over[near].sum())
            if mass <= _LEAST_MASS:
                return found
            share = left_over[near] / mass
            off = np.array([x[near] - middle_x, y[near] - middle_y, aside[near]])
            mean = (off * share).sum(1)
            middle_x, middle_y, middle_yaw = middle_x + mean[0], middle_y + mean[1], middle_yaw + mean[2]
            off = off - mean[:, None]
        square = np.einsum("in,jn->ij", off * share, off)
        spread = math.sqrt(square[0, 0] + square[1, 1])
        pose = Pose(float(middle_x), float(middle_y), math.remainder(float(middle_yaw), math.tau))
        found.append(Cluster(pose, mass, spread, upper(square)))
        left_over = np.where(near, 0.0, left_over)
    return found


def whole(cloud: Cloud) -> Cluster:
    """All of them as one."""
    x, y, yaw = cloud.sample(_ENOUGH).astype(np.float64)
    middle_yaw = math.atan2(np.sin(yaw).mean(), np.cos(yaw).mean())
    aside = (yaw - middle_yaw + math.pi) % math.tau - math.pi
    off = np.array([x - x.mean(), y - y.mean(), aside])
    square = np.einsum("in,jn->ij", off, off) / len(x)
    pose = Pose(float(x.mean()), float(y.mean()), middle_yaw)
    return Cluster(pose, 1.0, math.sqrt(square[0, 0] + square[1, 1]), upper(square))


def upper(square: npt.NDArray[np.float64]) -> Covariance:
    """Return the six values of a covariance of three."""
    xx, xy, xt, _, yy, yt, _, _, tt = (float(each) for each in square.ravel())
    return xx, xy, xt, yy, yt, tt
