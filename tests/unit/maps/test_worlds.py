"""The floor plans of this repository are what they are said to be."""

import itertools
import math
import random
from pathlib import Path

import pytest

from giraff_cli.motion.pattern import read_pattern
from giraff_maps.room_file import read_room_file
from giraff_sim.world.room import Room, read_room
from tests.support.robots import ROBOT
from tests.unit.maps.grids import FLAT, TWINS

ROOMS = {
    "living room": (0.0, 0.0, 4.8, 4.9),
    "bedroom": (0.0, 5.0, 4.8, 8.0),
    "kitchen": (4.9, 0.0, 8.7, 3.3),
    "study": (4.9, 5.0, 8.3, 8.0),
    "bathroom": (8.8, 0.0, 12.5, 3.3),
    "child's room": (8.4, 5.0, 12.5, 8.0),
}
"""Of the flat, inside: left, bottom, right, top."""
APART = 3.5  # m between the same place of the twins
REACH = 4.0  # m of a sensor


def test_the_flats_way_leads_through_every_room_and_clear_of_all() -> None:
    room = read_room(FLAT)
    for name, (left, bottom, right, top) in ROOMS.items():
        inside = [(x, y) for x, y in room.waypoints if left < x < right and bottom < y < top]
        assert len(inside) >= 3, name
    for (x, y), (to_x, to_y) in itertools.pairwise([*room.waypoints, room.waypoints[0]]):
        for part in range(21):
            clear = room.clearance(x + part / 20 * (to_x - x), y + part / 20 * (to_y - y))
            assert clear > ROBOT.footprint_radius, (x, y)


def test_a_byte_order_mark_is_no_part_of_a_room_or_a_pattern(tmp_path: Path) -> None:
    for read, path in ((read_room_file, FLAT), (read_pattern, Path("deploy/patterns/square.toml"))):
        marked = tmp_path / path.name
        marked.write_bytes(b"\xef\xbb\xbf" + path.read_bytes())
        assert read(marked) == read(path)


def _first(room: Room, x: float, y: float, direction: float) -> float | None:
    hit = room.ray(x, y, direction, REACH)
    return None if hit is None else hit.distance


def test_the_twins_are_the_same_from_inside() -> None:
    room, chance = read_room(TWINS), random.Random(1)
    seen = 0
    for _ in range(3000):
        x, y, direction = chance.uniform(0.02, 3.38), chance.uniform(0.02, 3.98), chance.uniform(-math.pi, math.pi)
        one, other = _first(room, x, y, direction), _first(room, x + APART, y, direction)
        assert one == pytest.approx(other, abs=1e-9)
        seen += one is not None
    assert seen > 2900


def test_the_turned_home_is_the_same_after_half_a_turn() -> None:
    room, chance = read_room(TWINS.with_name("turned.toml")), random.Random(1)
    for _ in range(1000):
        x, y, direction = chance.uniform(-4.9, 4.9), chance.uniform(-2.1, 2.1), chance.uniform(-math.pi, math.pi)
        assert _first(room, x, y, direction) == pytest.approx(_first(room, -x, -y, direction + math.pi), abs=1e-9)


def test_the_third_room_is_another() -> None:
    room, chance = read_room(TWINS), random.Random(1)
    differing = 0
    for _ in range(300):
        x, y, direction = chance.uniform(0.9, 2.3), chance.uniform(1.2, 3.2), chance.uniform(-math.pi, math.pi)
        differing += _first(room, x, y, direction) != pytest.approx(_first(room, x + 2 * APART, y, direction), abs=0.1)
    assert differing > 100


def test_the_twins_waypoints_stay_in_one() -> None:
    room = read_room(TWINS)
    assert all(0.0 < x < 3.4 and 0.0 < y < 4.0 for x, y in [*room.waypoints, room.start[:2]])
