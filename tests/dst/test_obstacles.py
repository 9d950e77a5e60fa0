"""What counts as driving at something that was heard: that surface, not another one beside the body."""

import math
from collections import deque

import pytest

from giraff_core.senses import Ultrasonic
from giraff_schemas.messages import Range
from giraff_sim.bodies.registry import world_of
from giraff_sim.config import SimConfig
from giraff_sim.dst.judging.ledger import Heard
from giraff_sim.dst.judging.obstacles import Obstacles
from giraff_sim.world.hand import StillHand
from giraff_sim.world.room import Pose, Room
from giraff_sim.world.sonar import SonarFault
from tests.dst.stage import SETTINGS

SENSOR = SETTINGS.robot.of(Ultrasonic)["front_left"]
RADIUS = SETTINGS.robot.footprint_radius
HEARD_US, NOW_US = 1_000_000, 1_100_000
SLOWLY, FAST = 0.257, 0.6
"""m/s; they stop within 0.02 and 0.12 m."""


def ahead(room: Room, speed: float, fault: SonarFault = SonarFault.NONE) -> str:
    """What the judge finds in a frame 0.1 s after the left sensor's ping, whatever a service made of that."""
    world = world_of(room, SETTINGS.robot, SETTINGS.base.drive, SimConfig(), StillHand(), seed=1)
    obstacles = Obstacles(world, SETTINGS)
    sonar = world.sonars[SENSOR.index]
    sonar.fault = fault
    sonar.echo_us(world.plant.pose)
    obstacles.note(HEARD_US)
    reading = Range(sensor="front_left", state="clear", range=None, echo_us=1, tick=None)
    readings = {name: deque[Heard]() for name in SETTINGS.robot.sensors}
    readings["front_left"].append(Heard(reading, HEARD_US, HEARD_US))
    return obstacles.ahead(speed, readings, NOW_US)


def room_with_wall(clearance: float) -> Room:
    """A wall across the way, that far from the body."""
    room = Room("wall", Pose(0.0, 0.0, 0.0))
    room.add_wall("wall", [(RADIUS + clearance, -3.0), (RADIUS + clearance, 3.0)])
    return room


@pytest.mark.parametrize(
    ("clearance", "speed", "found"),
    [(0.31, FAST, True), (0.33, FAST, False), (0.21, SLOWLY, True), (0.23, SLOWLY, False), (0.01, SLOWLY, True)],
)
def test_a_wall_ahead_nearer_than_the_stopping_distance_and_the_rest_of_the_margin_is_found(
    clearance: float, speed: float, found: bool
) -> None:
    told = ahead(room_with_wall(clearance), speed)
    assert bool(told) is found
    if found:
        assert f"now {clearance:.2f} m from the body" in told


def test_before_a_post_only_the_stopping_distance_counts() -> None:
    for clearance, found in ((0.10, True), (0.14, False)):
        room = Room("post", Pose(0.0, 0.0, 0.0))
        radius = 0.10
        x = math.sqrt((RADIUS + clearance + radius) ** 2 - SENSOR.y**2)
        room.add_post("post", x, SENSOR.y, radius)
        assert bool(ahead(room, FAST)) is found


def test_a_sensor_that_is_deaf_hears_nothing_that_counts() -> None:
    assert ahead(room_with_wall(0.01), FAST, SonarFault.DEAD) == ""


def test_what_has_come_since_the_ping_was_not_heard() -> None:
    world = world_of(hall := room_with_wall(3.0), SETTINGS.robot, SETTINGS.base.drive, SimConfig(), StillHand(), seed=1)
    obstacles = Obstacles(world, SETTINGS)
    world.sonars[SENSOR.index].echo_us(world.plant.pose)
    obstacles.note(HEARD_US)
    hall.add_wall("new", [(RADIUS + 0.1, -1.0), (RADIUS + 0.1, 1.0)])
    reading = Range(sensor="front_left", state="clear", range=None, echo_us=1, tick=None)
    readings = {name: deque[Heard]() for name in SETTINGS.robot.sensors}
    readings["front_left"].append(Heard(reading, HEARD_US, HEARD_US))
    assert obstacles.ahead(0.6, readings, NOW_US) == ""


def test_backing_away_from_it_is_right() -> None:
    assert ahead(room_with_wall(0.01), -FAST) == ""


def test_what_touches_the_side_is_not_what_was_heard_ahead() -> None:
    clearance = 0.34
    room = room_with_wall(clearance)
    room.add_post("beside", 0.1, RADIUS + 0.05, 0.05)
    assert room.clearance(0.0, 0.0) < RADIUS + 0.02
    assert ahead(room, FAST) == ""


def test_a_post_that_the_cone_only_grazes_was_not_heard_for_sure() -> None:
    room = Room("post", Pose(0.0, 0.0, 0.0))
    radius, distance = 0.10, 0.22
    off = math.radians(7.0) + math.asin(radius / distance)
    x, y = SENSOR.x + distance * math.cos(off), SENSOR.y - distance * math.sin(off)
    room.add_post("between the cones", x, y, radius)
    hit = room.ray(SENSOR.x, SENSOR.y, math.radians(-7.5), 1.0)
    assert hit is not None
    assert hit.incidence < math.cos(math.radians(60.0))
    assert ahead(room, FAST) == ""


def touch(
    room: Room,
    turned: float = 0.0,
    ago_us: int = 1_000_000,
    fault: SonarFault = SonarFault.DEAF,
    heard_from: Pose | None = None,
) -> str:
    """What the judge finds in a touch at 0.3 m/s of what was heard twice before: from half a metre, and `turned` rad,
    back, where no other place is given."""
    world = world_of(room, SETTINGS.robot, SETTINGS.base.drive, SimConfig(), StillHand(), seed=1)
    obstacles = Obstacles(world, SETTINGS)
    sonar = world.sonars[SENSOR.index]
    end = world.plant.pose
    world.plant.place(heard_from or Pose(end.x - 0.5, end.y, end.yaw + turned))
    for at_us in (HEARD_US - 180_000, HEARD_US):
        sonar.echo_us(world.plant.pose)
        obstacles.note(at_us)
    sonar.fault = fault
    world.plant.place(end)
    world.plant.speed = 0.3
    return obstacles.touched_too_fast(HEARD_US + ago_us)


def test_a_fast_touch_of_what_was_heard_before_the_sensor_was_deaf_is_found() -> None:
    assert "+0.30 m/s at the touch of what front_left heard 1.0 s ago" in touch(room_with_wall(0.0))


def test_a_slanted_wall_answers_from_the_edge_of_the_cone() -> None:
    slant = math.radians(24.0)
    foot = 1.7 * math.cos(slant), 1.7 * math.sin(slant)
    away = 1.7 - RADIUS
    room = Room("slanted", Pose(away * math.cos(slant), away * math.sin(slant), slant))
    room.add_wall("wall", [(foot[0] - k * math.sin(slant), foot[1] + k * math.cos(slant)) for k in (-4.0, 4.0)])
    assert "at the touch of what front_left heard" in touch(room, heard_from=Pose(0.0, 0.0, 0.0))


def test_another_touch_is_not_of_what_was_heard() -> None:
    beside = room_with_wall(0.2)
    beside.add_post("beside", 0.1, RADIUS + 0.04, 0.05)
    assert touch(beside) == ""
    assert touch(room_with_wall(0.0), turned=1.0) == ""
    assert touch(room_with_wall(0.0), ago_us=10_100_000) == ""
    assert touch(room_with_wall(0.0), fault=SonarFault.NONE) == ""
