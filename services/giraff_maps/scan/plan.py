"""A floor plan of what a mapper has kept, and how far to believe it: figures that need no truth."""

import math
from collections.abc import Iterator, Sequence
from typing import Final, NamedTuple

import msgspec
import numpy as np

from giraff_core.kinematics.pose import Pose
from giraff_maps.floor_plan import Wall
from giraff_maps.scan.graph import Edge
from giraff_maps.scan.mapper import KeyTurn, Mapper
from giraff_maps.scan.match import rotated
from giraff_maps.scan.occupancy import Looks, OccupancyGrid
from giraff_maps.scan.walls import WallFinder, doubled, faces_of
from giraff_schemas.trouble import Trouble

_DIRECTION_ROUNDS: Final = 3
_ASLANT: Final = math.radians(5.0)
_APART: Final = 1.0  # m
_SHORTEST: Final = 3.0  # m
_SLIDES: Final = 0.010  # m
_GAPES: Final = 0.015  # m
_DOUBLED: Final = 0.008
"""Limits of a good plan, as of `Figures`. They come from drives through four furnished homes, good ones and bad."""


class Figures(msgspec.Struct, frozen=True, kw_only=True):
    """Figures of a plan: how it was made, and how far it can be believed."""

    way: float
    """m driven."""
    key_turns: int
    loops: int
    """Places that the robot came back to, and knew again."""
    loop_gap: float
    """m by which the worst of them does not fit the plan."""
    slide: float
    """m by which walls let the robot slide in the worst twentieth of the key turns, as a standard deviation."""
    doubles: float
    """Share of the wall cells behind which the same wall stands again, 0..1."""
    lost: float
    """m of the longest way on which nothing fitted, and after which only a search found the robot, or none did."""
    missing: tuple[Trouble, ...]
    """Causes for which the plan is not good. Empty: it is."""


class MadePlan(NamedTuple):
    """A floor plan."""

    grid: OccupancyGrid
    walls: tuple[Wall, ...]
    """Straight walls, the longest first."""
    start: Pose
    """Place of the mapper's own frame in the plan: there the robot began."""
    way: tuple[tuple[float, float], ...]
    """Places (m) by which the robot came, a metre apart, and back to the first one."""
    figures: Figures


def make_plan(mapper: Mapper, mount: Pose, start: Pose | None = None) -> Iterator[MadePlan | float]:
    """Yield the share that is done (0..1) after each part of some hundredths of a second, and the plan at last.

    `mount`: of the scanner. `start`: pose of the mapper's frame in the plan; None: the plan's axes lie along the walls.
    The mapper has a key turn at least; what it takes meanwhile is not in the plan.
    """
    start = start or Pose(0.0, 0.0, -_direction(mapper.keys))
    keys = [key._replace(pose=key.pose.placed_in(start)) for key in mapper.keys]
    edges = tuple(mapper.edges)
    looks = Looks(keys, mount)
    for number, key in enumerate(keys):
        looks.add(key)
        yield number / len(keys) / 2.0
    grid = looks.grid()
    faces = faces_of(keys, grid)
    finder = WallFinder(faces)
    while finder.find():
        yield (1.0 + finder.done) / 2.0
    figures = _figures(keys, edges, doubled(faces, grid), mapper.lost)
    yield MadePlan(grid, tuple(finder.walls), start, _way(keys), figures)


def _direction(keys: Sequence[KeyTurn]) -> float:
    """Return the direction of most walls, rad, at most 45 degrees to either side."""
    normals = [rotated(key.pose.yaw, key.turn.cloud.normals) for key in keys]
    fourth = np.concatenate([each[:, 0] + 1j * each[:, 1] for each in normals]) ** 4
    along = fourth.sum()
    for _ in range(_DIRECTION_ROUNDS):  # what stands aslant is left out
        along = fourth[np.abs(np.angle(fourth * np.conj(along))) < 4.0 * _ASLANT].sum()
    return float(np.angle(along)) / 4.0


def _way(keys: Sequence[KeyTurn]) -> tuple[tuple[float, float], ...]:
    way = [keys[0].pose[:2]]
    for key in keys:
        if math.dist(key.pose[:2], way[-1]) >= _APART:
            way.append(key.pose[:2])
    if math.dist(way[0], way[-1]) > 2.0 * _APART:
        way += way[-2:0:-1]
    return tuple(way)


def _figures(keys: Sequence[KeyTurn], edges: Sequence[Edge], doubles: float, lost: float) -> Figures:
    gaps = [
        math.dist(keys[edge.end].pose.seen_from(keys[edge.begin].pose)[:2], edge.seen[:2])
        for edge in edges
        if edge.is_loop
    ]
    figures = Figures(
        way=keys[-1].way,
        key_turns=len(keys),
        loops=len(gaps),
        loop_gap=max(gaps, default=0.0),
        slide=float(np.quantile([key.slide for key in keys], 0.95)),
        doubles=doubles,
        lost=lost,
        missing=(),
    )
    return msgspec.structs.replace(figures, missing=tuple(_missing(figures)))


def _missing(figures: Figures) -> Iterator[Trouble]:
    if figures.way < _SHORTEST:
        yield Trouble(
            f"only {figures.way:.1f} m were driven, by odometry",
            "drive through all rooms, and if the robot has moved, check that giraff_odometry runs",
        )
    if not figures.loops:
        yield Trouble(
            "no place was seen a second time, so that nothing shows how far the plan is bent",
            "drive on, and come back to where you were another way round or from another side",
        )
    if figures.slide > _SLIDES:
        yield Trouble(
            f"walls let the robot slide by {figures.slide * 1000.0:.0f} mm, as in a smooth corridor",
            "open its doors, or set a box or two at its walls while you drive",
        )
    if figures.loop_gap > _GAPES:
        yield Trouble(
            f"a place that was seen again does not fit by {figures.loop_gap * 100.0:.1f} cm",
            "drive more slowly, once more round, and let nobody walk beside the robot",
        )
    if figures.doubles > _DOUBLED:
        yield Trouble(
            f"{figures.doubles:.1%} of the walls are drawn twice",
            "drive more slowly, once more round, and let nobody walk beside the robot",
        )
    if figures.lost:
        yield Trouble(
            f"on {figures.lost:.1f} m nothing that the scanner saw fitted",
            "begin anew, and neither lift nor push the robot on the way",
        )
