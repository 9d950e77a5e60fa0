"""A furnished room from a seed."""

from __future__ import annotations

import math
import random
from typing import Final

from giraff_sim.world.room import Pose, Room

_TRIES: Final = 200
_START_CLEARANCE: Final = 0.9  # m, of the robot's centre
_WAYPOINT_CLEARANCE: Final = 0.75
_BARE: Final = 0.5  # share of the rooms without a threshold
_HALF_THRESHOLD: Final = 2.0  # m


def random_room(chance: random.Random) -> Room:
    """Four walls, boxes and posts. Without walls nothing would echo, and the robot would only creep."""
    width, depth = chance.uniform(4.0, 6.5), chance.uniform(3.5, 5.5)
    room = Room("random", Pose(0.0, 0.0, 0.0))
    room.add_wall("walls", [(0.0, 0.0), (width, 0.0), (width, depth), (0.0, depth)], closed=True)
    for number in range(chance.randint(0, 3)):
        x, y, turn = chance.uniform(0.0, width), chance.uniform(0.0, depth), chance.uniform(0.0, math.pi)
        half_length, half_depth = chance.uniform(0.15, 0.6), chance.uniform(0.1, 0.3)
        cos, sin = math.cos(turn), math.sin(turn)
        corners = [(1, 1), (-1, 1), (-1, -1), (1, -1)]
        points = [
            (x + cos * a * half_length - sin * b * half_depth, y + sin * a * half_length + cos * b * half_depth)
            for a, b in corners
        ]
        room.add_wall(f"box {number}", points, closed=True)
    for number in range(chance.randint(0, 3)):
        room.add_post(
            f"post {number}", chance.uniform(0.0, width), chance.uniform(0.0, depth), chance.uniform(0.04, 0.25)
        )
    start = _free_place(room, chance, width, depth, _START_CLEARANCE)
    room.start = Pose(*start, chance.uniform(-math.pi, math.pi))
    room.waypoints = [_free_place(room, chance, width, depth, _WAYPOINT_CLEARANCE) for _ in range(4)]
    return room


def lay_threshold(room: Room, chance: random.Random) -> None:
    """In every other room, the edge of a carpet across the middle of where the robot is likely to drive."""
    if chance.random() < _BARE:
        return
    x = sum(place[0] for place in room.waypoints) / len(room.waypoints)
    y = sum(place[1] for place in room.waypoints) / len(room.waypoints)
    along = chance.uniform(-math.pi, math.pi)
    half_x, half_y = _HALF_THRESHOLD * math.cos(along), _HALF_THRESHOLD * math.sin(along)
    room.add_threshold("edge", (x - half_x, y - half_y), (x + half_x, y + half_y))


def _free_place(room: Room, chance: random.Random, width: float, depth: float, clearance: float) -> tuple[float, float]:
    """A place with that much room around it, m; the freest one found where the room is too full for it."""
    best, best_clearance = (width / 2.0, depth / 2.0), -math.inf
    for _ in range(_TRIES):
        place = chance.uniform(0.0, width), chance.uniform(0.0, depth)
        there = room.clearance(*place)
        if there > best_clearance:
            best, best_clearance = place, there
        if there >= clearance:
            break
    return best
