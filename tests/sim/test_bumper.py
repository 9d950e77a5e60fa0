"""A bumper is pushed by what touches its half of the robot's true disc, and its wire can be cut."""

import math

import pytest

from giraff_schemas.wire import BoardKind
from giraff_schemas.wires.bumper import BumperFrame, BumperRequestFrame
from giraff_sim.board import Implementation
from giraff_sim.bodies.registry import world_of
from giraff_sim.simulation import simulation
from giraff_sim.world.hand import StillHand
from giraff_sim.world.room import Pose
from giraff_sim.world.world import World
from tests.sim.line import Line
from tests.sim.robots import EXACT, room_with_wall
from tests.support.robots import BUMPED, DRIVE

WALL = 2.0


def world_at(pose: Pose) -> World:
    return world_of(room_with_wall(WALL, pose), BUMPED, DRIVE, EXACT, StillHand(), 1)


@pytest.mark.parametrize(
    ("gap", "yaw", "pushed"),
    [
        (0.0, 0.0, [True, False]),
        (0.0, math.pi, [False, True]),
        (0.0, 1.5, [True, False]),
        (0.0, 1.65, [False, True]),
        (0.001, 0.0, [True, False]),
        (0.004, 0.0, [False, False]),
    ],
)
def test_a_wall_pushes_the_half_that_it_touches(gap: float, yaw: float, pushed: list[bool]) -> None:
    pose = Pose(WALL - BUMPED.footprint_radius - gap, 0.0, yaw)
    world = world_at(pose)
    assert [bumper.is_open(pose) for _, bumper in sorted(world.bumpers.items())] == pushed


def test_a_person_at_the_side_pushes_the_half_on_which_they_stand() -> None:
    pose = Pose(0.0, 0.0, 0.0)
    world = world_at(pose)
    world.room.add_post("person", -0.1, 0.45, 0.15)
    assert [world.bumpers[number].is_open(pose) for number in (0, 1)] == [False, False]
    world.room.add_post("person", -0.1, math.sqrt(0.45**2 - 0.1**2), 0.15)
    assert [world.bumpers[number].is_open(pose) for number in (0, 1)] == [False, True]


def test_the_boards_pins_follow(implementation: Implementation) -> None:
    with simulation(world_at(Pose(0.0, 0.0, 0.0)), (BoardKind.RANGER,), implementation) as running:
        line = Line(running, BoardKind.RANGER)
        line.run(0.1)
        line.send(BumperRequestFrame(seq=1))
        told = []
        for pose, is_cut in ((0.0, False), (WALL - BUMPED.footprint_radius, False), (0.0, True)):
            running.world.plant.place(Pose(pose, 0.0, math.pi))
            running.world.bumpers[0].is_cut = is_cut
            line.run(0.1)
            told.append(line.last(BumperFrame).open)
        assert told == [0, 2, 1]
