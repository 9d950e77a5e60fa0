"""The room file, which the simulator drives in and localization looks for the robot on.

It is TOML, metres, with x to the east and y to the north:

    name = "living room"
    waypoints = [[4.6, 1.4], [1.4, 3.2]]      # for the demonstration's hand, in turn, for ever
    start = { x = 1.5, y = 2.2, yaw_deg = 0.0 }

    [[walls]]
    name = "sofa"
    points = [[1.5, 4.1], [3.5, 4.1], [3.5, 5.0]]
    closed = false                            # true: the last point is joined to the first

    [[posts]]
    name = "table leg"
    x = 4.7
    y = 3.6
    radius = 0.03

    [[thresholds]]                            # a wheel slips on it; it neither stops the robot nor echoes
    name = "carpet"
    points = [[2.0, 0.0], [2.0, 5.0]]
"""

import itertools
import math
import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import msgspec

from giraff_core.toml_kinds import ROOM, wrong_kind
from giraff_maps.floor_plan import FloorPlan, MapError, Wall, read_text
from giraff_schemas.text import plain

GRIDS: Final = (".yaml", ".yml")
"""How a grid's name ends."""
SHORTEST_WALL: Final = 1e-3
"""m: below it a segment has no direction worth the name."""
_CORNERS: Final = 8  # of a post where it is drawn

Point = tuple[float, float]
"""m."""


class _Strict(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    pass


class StartTable(_Strict, frozen=True, kw_only=True):
    """Where a simulated robot stands at first: m, m, degrees counter-clockwise from x."""

    x: float
    y: float
    yaw_deg: float


class WallTable(_Strict, frozen=True, kw_only=True):
    """A polyline, m; closed: its last point is joined to its first."""

    name: str
    points: list[Point]
    closed: bool = False


class PostTable(_Strict, frozen=True, kw_only=True):
    """An upright cylinder, m."""

    name: str
    x: float
    y: float
    radius: float


class ThresholdTable(_Strict, frozen=True, kw_only=True):
    """An edge on the floor, m; no wall."""

    name: str
    points: tuple[Point, Point]


class RoomFile(_Strict, frozen=True, kw_only=True):
    """What the file says."""

    name: str
    start: StartTable
    waypoints: list[Point] = []
    walls: list[WallTable] = []
    posts: list[PostTable] = []
    thresholds: list[ThresholdTable] = []


def read_room_file(path: Path) -> RoomFile:
    """What a room file says. Raises MapError; whether its walls and posts can be is not asked yet."""
    if path.suffix.lower() in GRIDS:
        raise MapError(
            f"{path}: it is a grid of ROS's map_server, and this takes a room (.toml), which also has a start: "
            "docs/maps.md shows how to write one; `giraff localize --map` takes grids"
        )
    try:
        tables = tomllib.loads(read_text(path))
    except (ValueError, RecursionError) as error:
        raise MapError(f"{path}: not TOML: {plain(error)}") from error
    try:
        content = msgspec.convert(tables, RoomFile)
    except ValueError as error:
        raise MapError(f"{path}: {wrong_kind(tables, ROOM) or plain(error)}") from error
    places = [(content.start.x, content.start.y, content.start.yaw_deg), *content.waypoints]
    if not all(math.isfinite(value) for place in places for value in place):
        raise MapError(f"{path}: start and waypoints must be finite numbers")
    return content


def room_plan(path: Path) -> FloorPlan:
    """Walls and posts of a room file. Raises MapError."""
    content = read_room_file(path)
    walls: list[Wall] = []
    try:
        for wall in content.walls:
            walls += wall_segments(wall.name, wall.points, closed=wall.closed)
        for post in content.posts:
            require_post(post.name, post.x, post.y, post.radius)
            walls += [(*begin, *end) for begin, end in itertools.pairwise(post_outline(post.x, post.y, post.radius))]
    except MapError as error:
        raise MapError(f"{path}: {error}") from error
    return FloorPlan(content.name, tuple(walls))


def wall_segments(name: str, points: Sequence[Point], *, closed: bool = False) -> list[Wall]:
    """The segments of a polyline. Raises MapError where it is none."""
    if len(points) < 2:
        raise MapError(f"wall {name!r} has {len(points)} points: it needs two or more")
    if closed and len(points) < 3:
        raise MapError(f"wall {name!r} has {len(points)} points: a closed one needs three or more")
    ends = [*points[1:], points[0]] if closed else points[1:]
    segments: list[Wall] = []
    for (x, y), (end_x, end_y) in zip(points, ends, strict=False):
        if not all(math.isfinite(value) for value in (x, y, end_x, end_y)):
            raise MapError(f"wall {name!r} has a point that is not finite")
        if math.hypot(end_x - x, end_y - y) < SHORTEST_WALL:
            raise MapError(f"wall {name!r} repeats the point ({x:g}, {y:g})")
        segments.append((x, y, end_x, end_y))
    return segments


def require_post(name: str, x: float, y: float, radius: float) -> None:
    """Raises MapError where that can be no post."""
    if not all(math.isfinite(value) for value in (x, y, radius)) or radius <= 0.0:
        raise MapError(f"post {name!r} at ({x:g}, {y:g}), radius {radius:g}: the radius must be positive")


def post_outline(x: float, y: float, radius: float) -> tuple[Point, ...]:
    """An octagon with its corners on the post, closed."""
    angles = (number * math.tau / _CORNERS for number in range(_CORNERS + 1))
    return tuple((x + radius * math.cos(angle), y + radius * math.sin(angle)) for angle in angles)
