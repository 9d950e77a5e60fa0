"""What a sensor is expected to hear, at every place and in every direction."""

import math
from collections.abc import Iterator
from itertools import islice, product
from typing import Any

import msgspec
import numpy as np
import pytest

from giraff_core.kinematics.pose import Pose
from giraff_core.senses import HC_SR04, Ultrasonic
from giraff_localization.beams import range_table
from giraff_localization.beams.range_table import CLEAR, SLANTED, SOLID
from giraff_localization.beams.readings import Readings
from giraff_localization.beams.ultrasonic import Beam
from giraff_localization.config import LocalizationConfig
from giraff_localization.fit import compare
from giraff_localization.floor import Floor
from giraff_localization.free_space import Floats
from giraff_localization.track import Track
from giraff_maps.floor_plan import FloorPlan, MapError
from tests.support.robots import ROBOT, ULTRASONIC
from tests.unit.localization.rooms import ROOM, echo, floor, odometry, outline

MIDDLE = (2.475, 1.525)
SLANTED_WALL = FloorPlan("slanted", (*ROOM.walls, (3.0, 0.0, 4.0, 3.0)))


def expected(place: tuple[float, float], degrees: float, plan: FloorPlan = ROOM) -> int:
    x, y = np.array([place[0]]), np.array([place[1]])
    return int(floor(plan).sonars.models[0].table.expected(x, y, np.array([math.radians(degrees)]))[0])


@pytest.mark.parametrize(("degrees", "distance"), [(0.0, 2.525), (90.0, 1.475), (180.0, 2.475), (270.0, 1.525)])
def test_a_wall_ahead_is_heard_at_its_distance(degrees: float, distance: float) -> None:
    assert expected(MIDDLE, degrees) * floor().sonars.models[0].table.bin == pytest.approx(distance, abs=0.03)


def test_whole_turns_are_the_same_heading() -> None:
    assert expected(MIDDLE, -90.0) == expected(MIDDLE, 270.0) == expected(MIDDLE, 630.0)


def test_a_wall_is_heard_up_to_25_degrees_of_slant() -> None:
    assert expected(MIDDLE, 25.0) < CLEAR
    assert expected(MIDDLE, 30.0) == SLANTED


def test_the_nearest_of_what_the_cone_meets_is_heard() -> None:
    straight, aside = expected(MIDDLE, 0.0), expected(MIDDLE, 5.0)
    assert aside == straight, "the wall's foot is still in the cone"


def test_nothing_within_reach_is_clear() -> None:
    long = FloorPlan("long", outline((0.0, 0.0), (8.0, 0.0), (8.0, 2.0), (0.0, 2.0)))
    assert expected((3.0, 1.0), 0.0, long) == CLEAR


def test_behind_a_wall_nothing_is_expected() -> None:
    far = (5.45, 1.5)
    assert expected(far, 0.0) in {CLEAR, SOLID}


def test_of_two_walls_the_first_is_heard() -> None:
    divided = FloorPlan("divided", (*ROOM.walls, (3.5, 0.0, 3.5, 3.0)))
    assert expected(MIDDLE, 0.0, divided) * floor(divided).sonars.models[0].table.bin == pytest.approx(1.025, abs=0.03)


def test_it_agrees_with_rays_cast_one_by_one() -> None:
    """In a room with a slanted wall, by the same law, told in another way."""
    table = floor(SLANTED_WALL).sonars.models[0].table
    limit = math.radians(25.0)
    same = []
    for x, y, degrees in product((0.475, 1.525, 2.625), (0.525, 1.475, 2.275), range(0, 360, 30)):
        axis, nearest = math.radians(degrees), math.inf
        for off in range(-7, 8):
            distance, normal = _first(x, y, axis + math.radians(off))
            if abs(math.remainder(normal - axis, math.pi)) <= limit:
                nearest = min(nearest, distance)
        found = int(table.expected(np.array([x]), np.array([y]), np.array([axis]))[0])
        is_echo = nearest < HC_SR04.reach
        same.append(
            abs(found * table.bin - nearest) < 0.06 if is_echo and found < CLEAR else is_echo == (found < CLEAR)
        )
    assert sum(same) >= 0.97 * len(same), "but for what is at the very limit"


def _first(x: float, y: float, angle: float) -> tuple[float, float]:
    """m to the first wall, and rad of its normal: by the wall's ends, in a frame that looks along the ray."""
    best, normal = math.inf, 0.0
    origin = Pose(x, y, angle)
    for x0, y0, x1, y1 in SLANTED_WALL.walls:
        (ahead, left), (other_ahead, other_left) = origin.sees(x0, y0), origin.sees(x1, y1)
        if left * other_left >= 0.0:
            continue
        distance = ahead + (other_ahead - ahead) * left / (left - other_left)
        if 0.0 < distance < best:
            best, normal = distance, math.atan2(y1 - y0, x1 - x0) + math.pi / 2.0
    return best, normal


def test_a_part_stays_small_however_many_walls_there_are(monkeypatch: pytest.MonkeyPatch) -> None:
    """Judged by what is tried on walls, 2000 pairs for each wall included, and not by the clock."""
    tried, in_reach, largest = list[int](), range_table._in_reach, 0

    def counted(walls: Floats, x: Floats, y: Floats, reach: float) -> Iterator[tuple[Floats, float, Any]]:
        for wall in in_reach(walls, x, y, reach):
            tried.append(x.size * wall[2].size + 2000)
            yield wall

    monkeypatch.setattr(range_table, "_in_reach", counted)
    specks = tuple((x / 2, y / 2, x / 2 + 0.05, y / 2) for x in range(40) for y in range(40) if (x + y) % 3)
    made = Floor(FloorPlan("specks", specks), LocalizationConfig(), ROBOT)
    for _ in islice(made.build(), 20):
        largest = max(largest, sum(tried))
        tried.clear()
    assert 800_000 < largest < 1_100_000


def test_a_robot_fits_where_no_wall_is_near() -> None:
    space = floor().space
    assert space.free.holds(*MIDDLE)
    assert not space.free.holds(0.1, 1.5), "in the wall"
    assert not space.free.holds(-0.3, 1.5), "outside"
    assert not space.free.holds(1e9, -1e9), "far off"
    assert space.area == pytest.approx((5.0 - 0.4) * (3.0 - 0.4), rel=0.1)


def test_a_plan_with_an_open_door_has_room_all_the_same() -> None:
    opened = FloorPlan("open", ((1.2, 0.0, 5.0, 0.0), (5.0, 0.0, 5.0, 3.0), (5.0, 3.0, 0.0, 3.0), (0.0, 3.0, 0.0, 0.0)))
    assert floor(opened).space.free.holds(*MIDDLE)


@pytest.mark.parametrize(
    ("scale", "words"), [(0.05, "has no room for a robot"), (1000.0, "is it in metres?"), (100.0, "is it in metres?")]
)
def test_a_map_of_another_scale_is_refused(scale: float, words: str) -> None:
    scaled = FloorPlan("room", tuple((a * scale, b * scale, c * scale, d * scale) for a, b, c, d in ROOM.walls))
    with pytest.raises(MapError, match=words):
        Floor(scaled, LocalizationConfig(), ROBOT)


def test_sensors_that_differ_are_expected_to_hear_each_what_its_kind_hears() -> None:
    short = {name: msgspec.structs.replace(each, reach=2.0) for name, each in ULTRASONIC.items()}
    robot = msgspec.structs.replace(ROBOT, sensors=ROBOT.sensors | {"rear": short["rear"]})
    made = Floor(ROOM, LocalizationConfig(), robot)
    assert list(made.build())[-1] == 1.0
    heard, way = Readings(robot.of(Ultrasonic), made.sonars), Track()
    way.on_odometry(odometry(1.0))
    for sensor in ULTRASONIC:
        heard.on_range(echo(sensor, 1.0, 2.5))
    heard.place(way)
    beams = heard.pop_beams(way.pose, 0.1)
    assert [(model.reach, [beam.reading for beam in alike]) for model, alike in made.sonars.alike(beams)] == [
        (4.0, [125, 125]),
        (2.0, [CLEAR]),
    ]
    ahead = [Beam(0.0, 0.0, 0.0, reading, 1.0, kind) for kind, reading in enumerate((126, CLEAR))]
    assert compare(made, Pose(*MIDDLE, 0.0), ahead) == (2.0, 0.0, 2.0)
    assert compare(made, Pose(*MIDDLE, 0.0), [beam._replace(kind=1 - beam.kind) for beam in ahead]).right == 0.0


def test_sensors_that_are_alike_share_one_table() -> None:
    short = {name: msgspec.structs.replace(each, reach=2.0) for name, each in ULTRASONIC.items()}
    alike = msgspec.structs.replace(ROBOT, sensors=short)
    for config, reach in ((LocalizationConfig(), 2.0), (LocalizationConfig(reach=3.0), 3.0)):
        assert [model.reach for model in Floor(ROOM, config, alike).sonars.models] == [reach]
