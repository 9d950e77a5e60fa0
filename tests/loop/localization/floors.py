"""The floors that a robot is looked for on: what stands there, beside what the map says of it."""

import math
import random
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from giraff_maps.room_file import Point
from giraff_sim.world.room import Pose, Room, read_room
from tests.support.robots import ROBOT

CELL: Final = 0.1  # m
_NEEDED: Final = ROBOT.footprint_radius + 0.05  # m from a surface to the middle of a robot that is driven there
_LEAST_LEFT: Final = 0.7  # share of the floor that pieces which are not on the map leave to drive on
_MOVED: Final = 0.25  # m, standard deviation
_SMALLEST_MOVED: Final = 0.12  # m: a wall is thinner
_LARGEST_MOVED: Final = 3.0  # m: a wall is longer
_SAME: Final = 1e-6  # m
_ROOT: Final = Path(__file__).parents[3]

FILES: Final = {
    "living_room": _ROOT / "deploy/worlds/living_room.toml",
    "flat": _ROOT / "deploy/worlds/flat.toml",
    "twins": _ROOT / "tests/data/worlds/twins.toml",
    "turned": _ROOT / "tests/data/worlds/turned.toml",
}

Cell = tuple[int, int]
Rectangle = tuple[float, float, float, float]
"""m; left, bottom, right, top."""


class Differences(NamedTuple):
    """How a floor differs from its map. What is random is normal, on either axis, for each piece by its name."""

    sloppy: float = 0.0
    """m, standard deviation: by how much all that stands there is beside its place."""
    moved: float = 0.0
    """Share of the furniture that was moved by 0.25 m (standard deviation)."""
    pieces: int = 0
    """Boxes that are not on the map."""


class Floor(NamedTuple):
    """A room, and where in it the middle of a robot can be, in cells of 0.1 m."""

    room: Room
    left: float
    bottom: float
    clearance: NDArray[np.float64]
    """m from the middle of each cell to what is nearest."""
    free: frozenset[Cell]
    """All that hang together with the start."""

    def cell(self, x: float, y: float) -> Cell:
        return math.floor((x - self.left) / CELL), math.floor((y - self.bottom) / CELL)

    def middle(self, cell: Cell) -> tuple[float, float]:
        return self.left + (cell[0] + 0.5) * CELL, self.bottom + (cell[1] + 0.5) * CELL

    def within(self, part: Rectangle | None) -> list[Cell]:
        """The free cells of a part, in their order."""
        cells = sorted(self.free)
        if part is None:
            return cells
        left, bottom, right, top = part
        middles = ((cell, self.middle(cell)) for cell in cells)
        return [cell for cell, (x, y) in middles if left <= x <= right and bottom <= y <= top]


def floor(world: str, differences: Differences, seed: int) -> Floor:
    """What stands there for this seed."""
    choose = random.Random(f"{seed}/floor")
    room = read_room(FILES[world])
    largest = len(free(room).free)
    while True:
        beside = _beside(room, differences, choose)
        found = free(beside)
        if len(found.free) >= _LEAST_LEFT * largest:
            break
    for number in range(differences.pieces):
        found = _with_piece(found, f"piece {number}", choose, largest)
    return found


def free(room: Room) -> Floor:
    """Where a robot gets from the start of a room."""
    points = np.array([point for line in room.outlines() for point in line])
    left, bottom = points.min(0)
    columns, rows = np.ceil((points.max(0) - (left, bottom)) / CELL).astype(int)
    x = left + (np.arange(columns) + 0.5)[:, None] * CELL
    y = bottom + (np.arange(rows) + 0.5)[None, :] * CELL
    clearance = np.full((columns, rows), math.inf)
    for _, start_x, start_y, along_x, along_y, length in room._segments:
        part = np.clip((x - start_x) * along_x + (y - start_y) * along_y, 0.0, length)
        np.minimum(clearance, np.hypot(x - start_x - part * along_x, y - start_y - part * along_y), out=clearance)
    for post in room._posts:
        np.minimum(clearance, np.hypot(x - post.x, y - post.y) - post.radius, out=clearance)
    without = Floor(room, float(left), float(bottom), clearance, frozenset())
    wide = {(int(i), int(j)) for i, j in np.argwhere(clearance >= _NEEDED)}
    start = without.cell(room.start.x, room.start.y)
    waiting = [min(wide, key=lambda cell: math.dist(cell, start))]
    reached = set(waiting)
    while waiting:
        i, j = waiting.pop()
        near = {(i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1)} & wide - reached
        reached |= near
        waiting += near
    return without._replace(free=frozenset(reached))


def _beside(room: Room, differences: Differences, choose: random.Random) -> Room:
    """The same room with each piece beside its place: each wall in one line, and each post."""
    made = Room(room.name, room.start)
    pieces: list[list[tuple[str, Point, Point]]] = []
    for name, x, y, along_x, along_y, length in room._segments:
        side = (name, (x, y), (x + length * along_x, y + length * along_y))
        goes_on = pieces and pieces[-1][-1][0] == name and math.dist(pieces[-1][-1][2], side[1]) < _SAME
        if goes_on:
            pieces[-1].append(side)
        else:
            pieces.append([side])
    for piece in pieces:
        points = [point for _, begin, end in piece for point in (begin, end)]
        sizes = [max(values) - min(values) for values in zip(*points, strict=True)]
        x, y = _shift(sizes, differences, choose)
        for name, begin, end in piece:
            made.add_wall(name, [(begin[0] + x, begin[1] + y), (end[0] + x, end[1] + y)])
    for post in room._posts:
        x, y = _shift([2.0 * post.radius] * 2, differences, choose)
        made.add_post(post.name, post.x + x, post.y + y, post.radius)
    for begin, end in room.thresholds:
        made.add_threshold("threshold", begin, end)
    return made


def _shift(sizes: list[float], differences: Differences, choose: random.Random) -> Point:
    is_furniture = max(sizes) < _LARGEST_MOVED and min(sizes) > _SMALLEST_MOVED
    sd = _MOVED if is_furniture and choose.random() < differences.moved else differences.sloppy
    return choose.gauss(0.0, sd), choose.gauss(0.0, sd)


def _with_piece(here: Floor, name: str, choose: random.Random, largest: int) -> Floor:
    """One more box, where it keeps no robot out of much of the floor."""
    cells = sorted(here.free)
    for _ in range(40):
        x, y = here.middle(choose.choice(cells))
        wide, deep = choose.uniform(0.15, 0.3), choose.uniform(0.15, 0.3)
        corners = [(x - wide, y - deep), (x + wide, y - deep), (x + wide, y + deep), (x - wide, y + deep)]
        here.room.add_wall(name, corners, closed=True)
        found = free(here.room)
        if len(found.free) >= _LEAST_LEFT * largest:
            return found
        here.room.remove(name)
    return here


def start_at(here: Floor, cell: Cell, yaw: float) -> Pose:
    """Set the start of the room."""
    here.room.start = Pose(*here.middle(cell), yaw)
    return here.room.start
