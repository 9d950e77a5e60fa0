"""Rooms: what the file may say, and where surfaces are."""

import itertools
import math
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from giraff_sim.world.room import Pose, Room, RoomError, read_room
from tests.sim.robots import ORIGIN, empty_room, room_with_wall

LIVING_ROOM = Path(__file__).parents[2] / "deploy" / "worlds" / "living_room.toml"
START = "start = { x = 0.0, y = 0.0, yaw_deg = 90.0 }\n"


def written(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "room.toml"
    path.write_text(text)
    return path


def test_the_living_room_is_a_room_with_a_way_round_for_the_robot() -> None:
    room = read_room(LIVING_ROOM)
    assert room.names == [
        "armchair",
        "hall",
        "plant pot",
        "room",
        "shelf",
        "sofa",
        "table leg north-east",
        "table leg north-west",
        "table leg south-east",
        "table leg south-west",
        "television",
    ]
    ends = [*room.waypoints, room.waypoints[0]]
    for (x, y), (to_x, to_y) in itertools.pairwise(ends):
        for step in range(21):
            part = step / 20
            # The guard's margin of 0.25 m beyond the footprint of 0.30 m, and some to steer with.
            assert room.clearance(x + part * (to_x - x), y + part * (to_y - y)) > 0.7


def test_a_file_says_where_things_are(tmp_path: Path) -> None:
    path = written(
        tmp_path,
        f'name = "small"\n{START}waypoints = [[1, 2]]\n'
        '[[walls]]\nname = "box"\npoints = [[1, -1], [2, -1], [2, 1], [1, 1]]\nclosed = true\n'
        '[[posts]]\nname = "leg"\nx = -1.0\ny = 0.0\nradius = 0.25\n'
        '[[thresholds]]\nname = "sill"\npoints = [[3, -1], [3, 1]]\n',
    )
    room = read_room(path)
    assert room.is_threshold_between((2.9, 0.0), (3.1, 0.1))
    assert not room.is_threshold_between((2.9, 1.1), (3.1, 1.1))
    assert room.names == ["box", "leg"]
    assert room.start == Pose(0.0, 0.0, math.pi / 2)
    assert room.waypoints == [(1.0, 2.0)]
    assert room.clearance(0.0, 0.0) == 0.75
    assert room.clearance(0.9, 0.0) == pytest.approx(0.1)
    assert room.clearance(3.0, 0.0) == 1.0


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("name = ", "not TOML"),
        (f'nam = "x"\n{START}', "unknown field `nam`"),
        ('name = "x"\n', "`start` is missing"),
        (f'name = "x"\n{START}walls = 3\n', "walls"),
        (f'name = "x"\n{START}[[walls]]\nname = "w"\npoints = [[0, 1]]\n', "'w' has 1 points"),
        (
            f'name = "x"\n{START}[[walls]]\nname = "w"\npoints = [[0, 1], [0, 1]]\n',
            r"repeats the point \(0, 1\)",
        ),
        (f'name = "x"\n{START}[[walls]]\nname = "w"\npoints = [[0, 1], [0, nan]]\n', "not finite"),
        (
            f'name = "x"\n{START}[[walls]]\nname = "w"\npoints = [[0, 1], [2, 1]]\nclosed = true\n',
            "needs three",
        ),
        (f'name = "x"\n{START}[[posts]]\nname = "p"\nx = 0\ny = 1\nradius = 0\n', "must be positive"),
        (f'name = "x"\n{START}[[thresholds]]\nname = "t"\npoints = [[0, 1]]\n', "thresholds"),
        (f'name = "x"\n{START}[[thresholds]]\nname = "t"\npoints = [[0, 1], [0, 1]]\n', "'t' must go from one"),
        ('name = "x"\nstart = { x = inf, y = 0.0, yaw_deg = 0.0 }\n', "finite"),
    ],
)
def test_a_mistake_is_named_with_its_file(tmp_path: Path, text: str, complaint: str) -> None:
    path = written(tmp_path, text)
    with pytest.raises(RoomError, match=complaint) as error:
        read_room(path)
    assert str(path) in str(error.value)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(RoomError, match=r"nowhere\.toml: cannot be read"):
        read_room(tmp_path / "nowhere.toml")


def test_walls_come_and_go_by_name() -> None:
    room = room_with_wall(2.0)
    version = room.version
    room.add_wall("second", [(1.0, -1.0), (1.0, 1.0)])
    assert room.version != version
    assert room.clearance(0.0, 0.0) == 1.0
    room.remove("second")
    assert room.clearance(0.0, 0.0) == 2.0
    with pytest.raises(RoomError, match="no wall or post 'second'; there are wall"):
        room.remove("second")


def test_an_empty_room_is_endless() -> None:
    assert empty_room().clearance(0.0, 0.0) == math.inf
    assert empty_room().ray(0.0, 0.0, 0.0, 4.0) is None


coordinates = st.floats(-3.0, 3.0).map(lambda value: round(value, 3))


@given(coordinates, coordinates, st.floats(-math.pi, math.pi))
def test_a_ray_ends_on_the_surface_it_met(x: float, y: float, direction: float) -> None:
    room = Room("round", ORIGIN)
    corners = [(4.0 * math.cos(k * math.tau / 7), 4.0 * math.sin(k * math.tau / 7)) for k in range(7)]
    room.add_wall("outside", corners, closed=True)
    room.add_post("post", 5.0, 5.0, 0.1)
    hit = room.ray(x, y, direction, 20.0)
    if room.clearance(x, y) > 1e-6 and math.hypot(x, y) < 3.5:
        assert hit is not None
        assert room.clearance(x + hit.distance * math.cos(direction), y + hit.distance * math.sin(direction)) < 1e-9
        assert hit.distance >= room.clearance(x, y) - 1e-9
        assert hit.incidence == pytest.approx(room.incidence(hit.surface, direction))


@given(coordinates, coordinates)
def test_nothing_faces_a_point_nearer_than_the_nearest_surface(x: float, y: float) -> None:
    room = Room("some", ORIGIN)
    room.add_wall("wall", [(-4.0, 3.5), (4.0, 3.5)])
    room.add_post("post", 0.0, -4.0, 0.5)
    assert len(room.facing(x, y)) == 2
    distances = [hit.distance for way in room.facing(x, y) if (hit := room.ray(x, y, way, 20.0)) is not None]
    assert min(distances) == pytest.approx(room.clearance(x, y))
    assert min(room.distance(surface, x, y) for surface in (0, 1)) == pytest.approx(room.clearance(x, y))
    normal = room.nearest(x, y)
    assert math.hypot(normal[1], normal[2]) == pytest.approx(1.0)


@given(coordinates, coordinates, st.floats(0.1, 9.0))
def test_the_points_of_a_surface_lie_on_it(x: float, y: float, distance: float) -> None:
    room = Room("some", ORIGIN)
    room.add_wall("wall", [(-4.0, 3.5), (4.0, 3.5)])
    room.add_post("post", 0.0, -4.0, 0.5)
    assert [room.name_of(surface) for surface in room.surfaces] == ["wall", "post"]
    for surface in room.surfaces:
        nearest = room.nearest_of(surface, x, y)
        assert room.distance(surface, *nearest) == pytest.approx(0.0, abs=1e-9)
        assert math.dist(nearest, (x, y)) == pytest.approx(room.distance(surface, x, y))
    for point in room.points_at(0, x, y, distance):
        assert point[1] == 3.5
        assert math.dist(point, (x, y)) == pytest.approx(max(distance, 3.5 - y))


def test_a_post_is_met_at_its_near_side() -> None:
    room = empty_room()
    room.add_post("post", 2.0, 0.0, 0.5)
    head_on = room.ray(0.0, 0.0, 0.0, 4.0)
    assert head_on is not None
    assert head_on.distance == 1.5
    assert head_on.incidence == 1.0
    assert room.ray(0.0, 0.0, math.pi, 4.0) is None
    assert room.ray(0.0, 0.0, math.radians(15.0), 4.0) is None
