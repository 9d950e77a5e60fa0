"""Homes as a laser scanner sees them: walls, dark and glass ones, people, and a way through all rooms."""

import heapq
import math
from collections.abc import Callable, Collection, Sequence
from functools import cache
from itertools import pairwise
from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

from giraff_core.kinematics.pose import Pose
from giraff_maps.room_file import Point, post_outline
from giraff_sim.world.ld19 import walls_met
from giraff_sim.world.room import Pose as Place
from giraff_sim.world.room import Room, read_room
from tests.rules.repository import ROOT

REACH: Final = 12.0
"""m, of the scanner."""
NOTHING: Final = 1e3
"""m that a ray tells which meets nothing."""
CLEAR: Final = 0.31
"""m from a way to all walls, at least."""
_CELL: Final = 0.1  # m, of the grid on which ways are sought
_SLACK: Final = 4.0  # rays by which a ray may be off where an even motion has it
_SEEN_GLASS, _LOST_GLASS = 0.97, 0.3  # cosine of the incidence from which glass is seen, and what is lost of it
_LEGS: Final = (-0.1, 0.0), (0.1, 0.05)
_HALF_LEG: Final = 0.05

Floats = npt.NDArray[np.float64]
Numbers = npt.NDArray[np.int64]
Person = Callable[[float, Pose], Point]
"""Gives where a person stands at a time (s), while the robot is there."""

ROUTES: Final[dict[str, list[Point]]] = {
    "living_room": [
        *((1.5, 2.2), (1.5, 1.4), (3.0, 1.4), (4.65, 1.2), (4.65, -0.5), (4.65, 1.2), (5.0, 2.6), (3.6, 2.9)),
        *((2.2, 3.2), (1.2, 3.2), (1.3, 2.0), (2.6, 2.4), (3.8, 2.0), (1.5, 2.2)),
    ],
    "twins": [
        *((1.0, 2.6), (1.0, 1.4), (2.4, 1.4), (2.65, 3.2), (2.65, 5.3), (1.1, 5.3), (6.15, 5.3), (6.15, 3.2)),
        *((4.5, 2.4), (4.6, 1.4), (5.9, 1.4), (6.15, 3.2), (6.15, 5.3), (8.5, 5.0), (8.5, 2.8), (8.7, 1.7)),
        *((8.5, 3.0), (9.6, 3.4), (8.5, 3.4), (8.5, 5.0), (2.65, 5.3), (2.65, 3.2), (1.0, 2.6)),
    ],
    "turned": [
        *((-1.2, 0.5), (-1.3, -0.9), (-1.5, 1.2), (-2.55, 1.6), (-3.2, 0.4), (-3.4, -1.0), (-3.0, 1.2), (-1.5, 1.2)),
        *((-0.7, 0.0), (0.7, 0.0), (1.5, -1.2), (2.55, -1.6), (3.2, -0.4), (3.4, 1.0), (3.0, -1.2), (1.5, -1.2)),
        *((1.3, 0.9), (0.7, 0.0), (-0.7, 0.0), (-1.2, 0.5)),
    ],
}
"""Goals of the homes whose waypoints do not lead through all rooms."""


class Met(NamedTuple):
    """Surfaces that the rays of a turn meet."""

    far: Floats
    """m of each ray; `NOTHING` where it meets none."""
    cosine: Floats
    """Cosine of the incidence."""
    dark: npt.NDArray[np.bool_]


class World:
    """A room whose walls have surfaces, and the way through it."""

    def __init__(
        self, room: Room, goals: Sequence[Point], *, dark: Collection[str] = (), glass: Collection[str] = ()
    ) -> None:
        """`dark`, `glass`: names of walls that the scanner loses from far, and sees near their normal only."""
        segments = [*room.walls]
        for name, x, y, radius in room.posts:
            segments += [(name, *begin, *end) for begin, end in pairwise(post_outline(x, y, radius))]
        self.goals = list(goals)
        self.names = sorted({name for name, *_ in segments})
        self.segments: Floats = np.array([ends for _, *ends in segments])
        """m: x, y of either end."""
        self._dark = np.array([name in dark for name, *_ in segments])
        self._glass = np.array([name in glass for name, *_ in segments])
        corners = self.segments.reshape(-1, 2)
        self._low = corners.min(axis=0)
        self._shape = np.ceil((corners.max(axis=0) - self._low) / _CELL).astype(int) + 1
        cells = np.stack(np.meshgrid(*map(np.arange, self._shape), indexing="ij"), axis=-1).reshape(-1, 2)
        self._clear = self.distances(cells * _CELL + self._low)
        self._free = cells[self._clear > CLEAR]
        self._ways: dict[tuple[Point, ...], list[Point]] = {}

    def distances(self, points: Floats) -> Floats:
        """Return m from each point to the nearest wall."""
        best, (xs, ys) = np.full(len(points), NOTHING**2), np.ascontiguousarray(points.T)
        for x, y, end_x, end_y in self.segments.tolist():
            off_x, off_y, along_x, along_y = xs - x, ys - y, end_x - x, end_y - y
            part = np.clip((off_x * along_x + off_y * along_y) / (along_x**2 + along_y**2), 0.0, 1.0)
            np.minimum(best, (off_x - part * along_x) ** 2 + (off_y - part * along_y) ** 2, out=best)
        found: Floats = np.sqrt(best)
        return found

    def is_clear(self, point: Point) -> bool:
        """Tell whether the robot may stand there."""
        return bool(self.distances(np.array([point]))[0] > CLEAR)

    def way(self, goals: Sequence[Point]) -> list[Point]:
        """Return points `_CELL` m apart on a way from goal to goal, `CLEAR` m from all walls at least."""
        if (key := tuple(goals)) not in self._ways:
            self._ways[key] = [at for begin, end in pairwise(goals) for at in self._path(begin, end)]
        return self._ways[key]

    def _cell(self, point: Point) -> int:
        squared = ((self._free * _CELL + self._low - point) ** 2).sum(axis=1)
        column, row = self._free[squared.argmin()]
        return int(column * self._shape[1] + row)

    def _path(self, begin: Point, end: Point) -> list[Point]:
        """A* (Hart, Nilsson, Raphael 1968), where a way near walls counts longer."""
        rows = int(self._shape[1])
        start, goal = self._cell(begin), self._cell(end)
        clear: list[float] = self._clear.tolist()
        steps = [(i * rows + j, math.hypot(i, j)) for i in (-1, 0, 1) for j in (-1, 0, 1) if i or j]
        costs, before, queue = {start: 0.0}, {start: start}, [(0.0, 0.0, start)]
        while queue:
            _, cost, at = heapq.heappop(queue)
            if at == goal:
                break
            if cost > costs[at]:
                continue
            for step, far in steps:
                if clear[to := at + step] <= CLEAR:
                    continue
                new = cost + far * (1.0 + 0.4 / clear[to])
                if new < costs.get(to, math.inf):
                    costs[to], before[to] = new, at
                    left = math.hypot(to // rows - goal // rows, to % rows - goal % rows)
                    heapq.heappush(queue, (new + left, new, to))
        way = [goal]
        while way[-1] != start:
            way.append(before[way[-1]])
        return [(self._low[0] + at // rows * _CELL, self._low[1] + at % rows * _CELL) for at in reversed(way)]

    def met(self, origins: Floats, bearings: Floats, people: Sequence[Point], chance: np.random.Generator) -> Met:
        """Return what each ray meets from its own origin. Bearings grow or fall evenly, about once round."""
        segments = np.concatenate([self.segments, *(_leg(x + i, y + j) for x, y in people for i, j in _LEGS)])
        bare = np.zeros(len(segments) - len(self.segments), bool)
        dark, glass = np.append(self._dark, bare), np.append(self._glass, bare)
        rays, numbers = _pairs(segments, origins, bearings)
        x, y = origins[rays].T
        far, cosine = walls_met(segments[numbers].T, x, y, np.cos(bearings)[rays], np.sin(bearings)[rays])
        if glass.any():
            unseen = (cosine < _SEEN_GLASS) | (chance.random(len(far)) < _LOST_GLASS)
            far = np.where(glass[numbers] & unseen, NOTHING, far)
        nearest = np.full(len(bearings), NOTHING)
        np.minimum.at(nearest, rays, far)
        first = far == nearest[rays]
        cosines, darks = np.ones(len(bearings)), np.zeros(len(bearings), bool)
        cosines[rays[first]], darks[rays[first]] = cosine[first], dark[numbers[first]]
        return Met(nearest, cosines, darks)


def _leg(x: float, y: float) -> Floats:
    left, low, right, high = x - _HALF_LEG, y - _HALF_LEG, x + _HALF_LEG, y + _HALF_LEG
    return np.array(
        [(left, low, right, low), (right, low, right, high), (right, high, left, high), (left, high, left, low)]
    )


def _pairs(segments: Floats, origins: Floats, bearings: Floats) -> tuple[Numbers, Numbers]:
    """Return rays and segments that may meet, and some more: a broadcast of all with all takes four times as long."""
    middle, count = origins.mean(axis=0), len(bearings)
    spread = float(np.hypot(*(origins - middle).T).max())
    begin, end = (segments - np.tile(middle, 2)).reshape(-1, 2, 2).transpose(1, 0, 2)
    along = end - begin
    part = np.clip(-(begin * along).sum(axis=1) / (along**2).sum(axis=1), 0.0, 1.0)
    apart = np.hypot(*(begin + part[:, None] * along).T)
    from_angle = np.arctan2(begin[:, 1], begin[:, 0])
    turn = (np.arctan2(end[:, 1], end[:, 0]) - from_angle + math.pi) % math.tau - math.pi
    margin = np.where(apart > spread, np.arcsin(np.minimum(1.0, spread / np.maximum(apart, 1e-9))), math.pi)
    slope = (bearings[-1] - bearings[0]) / (count - 1)
    ends = np.stack([np.minimum(0.0, turn) - margin, np.maximum(0.0, turn) + margin]) + from_angle - bearings[0]
    low, high = np.sort(ends / slope, axis=0)
    turns = math.tau / abs(slope)
    low, high = low - low // turns * turns, high - low // turns * turns
    first = np.clip(np.concatenate([low - turns, low, low + turns]) - _SLACK, 0, count).astype(np.int64)
    last = np.clip(np.concatenate([high - turns, high, high + turns]) + _SLACK, -1, count - 1).astype(np.int64)
    counts = np.maximum(0, last - first + 1) * np.tile(apart < REACH, 3)
    rays = np.arange(counts.sum()) + np.repeat(first - np.cumsum(counts) + counts, counts)
    return rays, np.repeat(np.tile(np.arange(len(segments)), 3), counts)


@cache
def home(name: str, *, dark: tuple[str, ...] = (), glass: tuple[str, ...] = ()) -> World:
    """Return the world of a room file by its stem."""
    [path] = [path for part in ("deploy", "tests/data") for path in (ROOT / part / "worlds").glob(f"{name}.toml")]
    room = read_room(path)
    return World(room, ROUTES.get(name, [room.start[:2], *room.waypoints]), dark=dark, glass=glass)


@cache
def corridor() -> World:
    """Return a smooth corridor of 30 x 1.6 m, whose walls do not tell how far along it the robot is."""
    room = Room("corridor", Place(1.0, 0.8, 0.0))
    room.add_wall("wall", [(0.0, 0.0), (30.0, 0.0), (30.0, 1.6), (0.0, 1.6)], closed=True)
    return World(room, [(1.0, 0.8), (29.0, 0.8), (1.0, 0.8)])


def beside(number: int, distance: float = 1.2) -> Person:
    """Return one of the people who walk round the robot all the way."""

    def stands(time: float, robot: Pose) -> Point:
        angle = 0.4 * time + 2.1 * number
        far = distance + 0.3 * math.sin(0.7 * time + number)
        return robot.x + far * math.cos(angle), robot.y + far * math.sin(angle)

    return stands
