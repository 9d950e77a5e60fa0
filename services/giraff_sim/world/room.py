"""A room: walls, posts, edges on the floor, where the robot starts and where a hand would steer it."""

import math
from pathlib import Path
from typing import NamedTuple

from giraff_maps.floor_plan import MapError
from giraff_maps.room_file import (
    SHORTEST_WALL,
    Point,
    post_outline,
    read_room_file,
    require_post,
    wall_segments,
)

RoomError = MapError
"""A room file, or a change of a room, that cannot be used. The message names the place."""


class Pose(NamedTuple):
    """Where something is: m, m, radians counter-clockwise from x."""

    x: float
    y: float
    yaw: float


class Hit(NamedTuple):
    """What a ray meets first."""

    distance: float
    """m along the ray."""
    surface: int
    """The surface's number, the same for all rays until the room changes."""
    incidence: float
    """Cosine of the angle between the ray and the surface's normal, 0..1."""
    round: bool
    """A post: it has a point that faces every ray's origin."""


class _Segment(NamedTuple):
    name: str
    x: float
    y: float
    along_x: float  # unit vector from one end to the other
    along_y: float
    length: float


class _Post(NamedTuple):
    name: str
    x: float
    y: float
    radius: float


class Room:
    """Surfaces that stop a robot and echo its pings. Walls can be added and removed by name."""

    def __init__(self, name: str, start: Pose, waypoints: list[tuple[float, float]] | None = None) -> None:
        self.name = name
        self.start = start
        self.waypoints = waypoints or []
        self.version = 0
        """Changes with the room."""
        self._segments: list[_Segment] = []
        self._posts: list[_Post] = []
        self.thresholds: list[tuple[Point, Point]] = []
        """Edges on the floor, from one end to the other."""

    def add_wall(self, name: str, points: list[tuple[float, float]], *, closed: bool = False) -> None:
        """A polyline through `points`."""
        for x, y, end_x, end_y in wall_segments(name, points, closed=closed):
            length = math.hypot(end_x - x, end_y - y)
            self._segments.append(_Segment(name, x, y, (end_x - x) / length, (end_y - y) / length, length))
        self.version += 1

    def add_post(self, name: str, x: float, y: float, radius: float) -> None:
        """An upright cylinder."""
        require_post(name, x, y, radius)
        self._posts.append(_Post(name, x, y, radius))
        self.version += 1

    def add_threshold(self, name: str, begin: Point, end: Point) -> None:
        """The edge of a carpet, or a sill, from `begin` to `end`, on which a wheel slips."""
        if not all(math.isfinite(value) for value in (*begin, *end)) or math.dist(begin, end) < SHORTEST_WALL:
            raise RoomError(f"threshold {name!r} must go from one place to another")
        self.thresholds.append((begin, end))

    def is_threshold_between(self, one: Point, other: Point) -> bool:
        """Whether the way from one point straight to another leads over a threshold."""
        return any(
            _side(begin, end, one) != _side(begin, end, other) and _side(one, other, begin) != _side(one, other, end)
            for begin, end in self.thresholds
        )

    @property
    def walls(self) -> list[tuple[str, float, float, float, float]]:
        """Name and ends of each segment."""
        return [
            (name, x, y, x + along_x * length, y + along_y * length)
            for name, x, y, along_x, along_y, length in self._segments
        ]

    @property
    def posts(self) -> list[tuple[str, float, float, float]]:
        """Name, middle and radius of each post."""
        return [(post.name, post.x, post.y, post.radius) for post in self._posts]

    def outlines(self) -> list[tuple[Point, ...]]:
        """Lines that show all walls and posts, for whoever draws them."""
        walls = [((x, y), (end_x, end_y)) for _, x, y, end_x, end_y in self.walls]
        posts = [post_outline(post.x, post.y, post.radius) for post in self._posts]
        return [*walls, *posts]

    def remove(self, name: str) -> None:
        """Take away every wall and post called `name`."""
        segments = [segment for segment in self._segments if segment.name != name]
        posts = [post for post in self._posts if post.name != name]
        if len(segments) == len(self._segments) and len(posts) == len(self._posts):
            raise RoomError(f"there is no wall or post {name!r}; there are {', '.join(self.names) or 'none'}")
        self._segments, self._posts = segments, posts
        self.version += 1

    @property
    def names(self) -> list[str]:
        """What stands in the room."""
        return sorted({segment.name for segment in self._segments} | {post.name for post in self._posts})

    @property
    def surfaces(self) -> range:
        """The numbers of all surfaces."""
        return range(len(self._segments) + len(self._posts))

    def name_of(self, surface: int) -> str:
        """What one surface is called."""
        walls = len(self._segments)
        return self._segments[surface].name if surface < walls else self._posts[surface - walls].name

    def clearance(self, x: float, y: float) -> float:
        """m from a point to the nearest surface; infinite in an empty room."""
        return self.nearest(x, y)[0]

    def nearest(self, x: float, y: float) -> tuple[float, float, float]:
        """m from a point to the nearest surface, and the unit vector from there to the point."""
        best = math.inf
        from_x = from_y = 0.0
        for _, start_x, start_y, along_x, along_y, length in self._segments:
            offset_x, offset_y = x - start_x, y - start_y
            part = offset_x * along_x + offset_y * along_y
            part = 0.0 if part < 0.0 else min(part, length)
            offset_x -= part * along_x
            offset_y -= part * along_y
            distance = math.sqrt(offset_x * offset_x + offset_y * offset_y)
            if distance < best:
                best, from_x, from_y = distance, offset_x, offset_y
        norm = best or 1.0
        for post in self._posts:
            offset_x, offset_y = x - post.x, y - post.y
            to_centre = math.hypot(offset_x, offset_y)
            if to_centre - post.radius < best:
                best, from_x, from_y, norm = to_centre - post.radius, offset_x, offset_y, to_centre or 1.0
        return best, from_x / norm, from_y / norm

    def distance(self, surface: int, x: float, y: float) -> float:
        """m from a point to one surface; negative in a post."""
        if surface >= len(self._segments):
            post = self._posts[surface - len(self._segments)]
            return math.hypot(x - post.x, y - post.y) - post.radius
        return math.dist((x, y), self.nearest_of(surface, x, y))

    def nearest_of(self, surface: int, x: float, y: float) -> Point:
        """The point of one surface that is nearest to a point."""
        if surface >= len(self._segments):
            post = self._posts[surface - len(self._segments)]
            share = post.radius / math.hypot(x - post.x, y - post.y)
            return post.x + (x - post.x) * share, post.y + (y - post.y) * share
        segment = self._segments[surface]
        part = (x - segment.x) * segment.along_x + (y - segment.y) * segment.along_y
        part = min(segment.length, max(0.0, part))
        return segment.x + part * segment.along_x, segment.y + part * segment.along_y

    def points_at(self, wall: int, x: float, y: float, distance: float) -> tuple[Point, Point]:
        """The two points of a wall's line that are `distance` m from a point; its foot twice where none is."""
        segment = self._segments[wall]
        foot = (x - segment.x) * segment.along_x + (y - segment.y) * segment.along_y
        across = (y - segment.y) * segment.along_x - (x - segment.x) * segment.along_y
        half = math.sqrt(max(0.0, distance**2 - across**2))
        begin, end = foot - half, foot + half
        return (
            (segment.x + begin * segment.along_x, segment.y + begin * segment.along_y),
            (segment.x + end * segment.along_x, segment.y + end * segment.along_y),
        )

    def facing(self, x: float, y: float) -> list[float]:
        """Directions (radians) from a point to every surface point whose normal aims back at it."""
        directions = [math.atan2(post.y - y, post.x - x) for post in self._posts]
        for segment in self._segments:
            part = (x - segment.x) * segment.along_x + (y - segment.y) * segment.along_y
            if 0.0 < part < segment.length:
                foot_x, foot_y = segment.x + part * segment.along_x, segment.y + part * segment.along_y
                directions.append(math.atan2(foot_y - y, foot_x - x))
        return directions

    def ray(self, x: float, y: float, direction: float, limit: float) -> Hit | None:
        """The first surface from a point in a direction (radians), within `limit` m."""
        cos, sin = math.cos(direction), math.sin(direction)
        best, found = limit, -1
        for number, (_, start_x, start_y, along_x, along_y, length) in enumerate(self._segments):
            across = cos * along_y - sin * along_x
            if across == 0.0:
                continue
            offset_x, offset_y = start_x - x, start_y - y
            distance = (offset_x * along_y - offset_y * along_x) / across
            if 0.0 <= distance < best and 0.0 <= (offset_x * sin - offset_y * cos) / across <= length:
                best, found = distance, number
        for number, post in enumerate(self._posts, len(self._segments)):
            offset_x, offset_y = post.x - x, post.y - y
            along = offset_x * cos + offset_y * sin
            miss = offset_x * sin - offset_y * cos
            if along <= 0.0 or abs(miss) >= post.radius:
                continue
            distance = max(0.0, along - math.sqrt(post.radius**2 - miss**2))
            if distance < best:
                best, found = distance, number
        if found < 0:
            return None
        if found < len(self._segments):
            segment = self._segments[found]
            return Hit(best, found, abs(cos * segment.along_y - sin * segment.along_x), round=False)
        post = self._posts[found - len(self._segments)]
        normal_x, normal_y = x + best * cos - post.x, y + best * sin - post.y
        return Hit(best, found, min(1.0, abs(cos * normal_x + sin * normal_y) / post.radius), round=True)

    def incidence(self, surface: int, direction: float) -> float:
        """Cosine of the angle between a direction (radians) and a wall's normal."""
        segment = self._segments[surface]
        return abs(math.cos(direction) * segment.along_y - math.sin(direction) * segment.along_x)


def read_room(path: Path) -> Room:
    """The room in a file. Raises RoomError."""
    content = read_room_file(path)
    start = Pose(content.start.x, content.start.y, math.radians(content.start.yaw_deg))
    room = Room(content.name, start, content.waypoints)
    try:
        for wall in content.walls:
            room.add_wall(wall.name, wall.points, closed=wall.closed)
        for post in content.posts:
            room.add_post(post.name, post.x, post.y, post.radius)
        for threshold in content.thresholds:
            room.add_threshold(threshold.name, *threshold.points)
    except RoomError as error:
        raise RoomError(f"{path}: {error}") from error
    return room


def _side(begin: Point, end: Point, point: Point) -> bool:
    """Whether a point lies to the left of the line through two others, or on it."""
    return (end[0] - begin[0]) * (point[1] - begin[1]) >= (end[1] - begin[1]) * (point[0] - begin[0])
