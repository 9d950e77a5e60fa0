"""The walls of a floor plan as a laser scanner sees them.

A wall drawn as one line has two faces. A wall drawn as two lines, and a thin piece of furniture, shows its outer faces
only: a turn that is matched with an inner one is off by the thickness of the wall.
"""

import math
from collections.abc import Generator, Iterator
from typing import Final

import numpy as np
import numpy.typing as npt

from giraff_maps.floor_plan import FloorPlan
from giraff_maps.scan.match import CELL, Cloud, Field, Floats, rotated

_APART: Final = 0.025  # m between two points of a wall
_BEFORE: Final = 0.16  # m before a face, where another wall is looked for
_HIDES: Final = 0.13  # m from there within which one hides it: it is 3 to 29 cm before that face
_PARALLEL: Final = 0.7  # cosine
_SPLIT: Final = 0.4  # rad: faces are told apart by which half of all directions they look to
_SIGMA: Final = 0.12  # m: standard deviation of a point off its wall, of scores
_ON_WALL: Final = 0.15  # m: less, and the small errors of a plan choose between rooms that are alike
_POINTS: Final = 60  # of a turn, that are scored
_RIM_CELLS: Final = 150  # of a field, half of those round about the plan in which points may lie: 12 m
_PART: Final = 600_000  # points that one part looks up: some milliseconds
_TOP: Final = 200  # scores of each heading, among which the best are sought
_SAME, _SAME_YAW = 0.35, 0.2  # m, rad between two poses that are one


class PlanWalls:
    """Walls of a floor plan. Of no use until they are built."""

    def __init__(self, plan: FloorPlan) -> None:
        self._plan = plan
        self._near = self._one = self._other = Field([Cloud(np.zeros((0, 2)), np.zeros((0, 2)))])
        self._likely = np.zeros((1, 1), np.float32)

    def build(self) -> Iterator[float]:
        """Compute it bit by bit; tells the share that is done after each."""
        points, normals = _points(np.array(self._plan.walls))
        self._near = Field([Cloud(points, normals)])
        yield 0.4
        self._one = Field([self._seen(points, normals)])
        yield 0.7
        self._other = Field([self._seen(points, -normals)])
        yield 0.9
        self._likely = self._near.likelihood(_SIGMA, _RIM_CELLS)
        yield 1.0

    def alike(self, points: Floats, normals: Floats) -> tuple[Floats, Floats, npt.NDArray[np.bool_]]:
        """Return the nearest point of each with the same face of a wall, its normal, and whether there is one."""
        sides = [side.alike(points, normals) for side in (self._one, self._other)]
        (at, found, known), (other_at, other_found, other_known) = sides
        far, other_far = (
            np.where(is_known, ((points - place) ** 2).sum(axis=1), np.inf) for place, _, is_known in sides
        )
        other = (other_far < far)[:, None]
        return np.where(other, other_at, at), np.where(other, other_found, found), known | other_known

    def explained(self, points: Floats) -> float:
        """Return the share of the points that lie on walls, whichever side they are seen from."""
        at, _, known = self._near.nearest(points)
        return float(np.count_nonzero(known & (((points - at) ** 2).sum(axis=1) < _ON_WALL**2))) / max(1, len(points))

    def best(self, points: Floats, places: Floats, headings: Floats, most: int) -> Generator[None, None, list[Floats]]:
        """Score a turn at each place (m) with each heading (rad), in parts. Return the best poses, best first."""
        points = points[np.linspace(0, len(points) - 1, _POINTS).astype(int)]
        points = points[np.hypot(*points.T) < 2 * _RIM_CELLS * CELL]
        width, likely, rim = self._likely.shape[1], self._likely.ravel(), 2 * _RIM_CELLS
        base = (self._near.cells(places) + rim) @ (width, 1)
        at_once, tried = max(1, _PART // max(1, len(points))), 0
        scored = [np.zeros((0, 4))]
        for heading in headings if len(places) else ():
            beside = np.rint(rotated(heading, points) / CELL).astype(np.int64) @ (width, 1)
            scores = np.zeros(len(places), np.float32)
            for first in range(0, len(places), at_once):
                part = slice(first, first + at_once)
                scores[part] = likely[base[part, None] + beside].sum(axis=1)
                tried += len(scores[part]) * len(points)
                if tried >= _PART:
                    yield
                    tried = 0
            top = np.argpartition(scores, -min(_TOP, len(scores)))[-_TOP:]
            scored.append(np.column_stack([places[top], np.full(len(top), heading), scores[top]]))
        left, found = np.concatenate(scored), list[Floats]()
        left = left[np.argsort(-left[:, 3], kind="stable")[: 20 * _TOP], :3]
        while len(left) and len(found) < most:
            found.append(left[0])
            turned = np.abs((left[:, 2] - left[0, 2] + math.pi) % math.tau - math.pi)
            left = left[(np.hypot(*(left[:, :2] - left[0, :2]).T) > _SAME) | (turned > _SAME_YAW)]
        return found

    def _seen(self, points: Floats, normals: Floats) -> Cloud:
        """Return these faces without the hidden ones."""
        before = points + _BEFORE * normals
        at, found, known = self._near.nearest(before)
        is_hidden = known & (np.hypot(*(before - at).T) < _HIDES)
        is_hidden &= np.abs((found * normals).sum(axis=1)) > _PARALLEL
        return Cloud(points[~is_hidden], normals[~is_hidden])


def _points(walls: Floats) -> tuple[Floats, Floats]:
    """Return points along all walls, and the normals there that look to one half of all directions."""
    begin, along = walls[:, :2], walls[:, 2:] - walls[:, :2]
    length = np.hypot(*along.T)
    begin, along, length = begin[length > 0.0], along[length > 0.0], length[length > 0.0]
    counts = np.maximum(2, np.ceil(length / _APART).astype(int) + 1)
    wall = np.repeat(np.arange(len(counts)), counts)
    part = (np.arange(len(wall)) - (np.cumsum(counts) - counts)[wall]) / (counts - 1)[wall]
    normals = np.column_stack([-along[:, 1], along[:, 0]]) / length[:, None]
    normals *= np.where(normals @ (math.cos(_SPLIT), math.sin(_SPLIT)) < 0.0, -1.0, 1.0)[:, None]
    return begin[wall] + part[:, None] * along[wall], normals[wall]
