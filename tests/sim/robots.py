"""The robots and rooms of these tests."""

from giraff_sim.bodies.registry import world_of
from giraff_sim.config import SimConfig
from giraff_sim.truth import Truth
from giraff_sim.world.hand import StillHand
from giraff_sim.world.room import Pose, Room
from giraff_sim.world.world import World
from tests.support.robots import DRIVE, ROBOT

EXACT = SimConfig(tilt_noise=0.0, battery_sag_volts=0.0, battery_volts=24.0)
"""Nothing random, and a battery that holds its nominal voltage."""

ORIGIN = Pose(0.0, 0.0, 0.0)


def empty_room(start: Pose = ORIGIN) -> Room:
    return Room("empty", start)


def proving_room(start: Pose = ORIGIN, half: float = 4.0) -> Room:
    """Four walls, `half` m from the middle: near enough for each sensor to prove that it hears, with way to drive."""
    room = Room("proving", start)
    room.add_wall("walls", [(half, half), (-half, half), (-half, -half), (half, -half)], closed=True)
    return room


def room_with_wall(x: float, start: Pose = ORIGIN) -> Room:
    """A wall across the x axis, 20 m wide."""
    room = empty_room(start)
    room.add_wall("wall", [(x, -10.0), (x, 10.0)])
    return room


def world_in(room: Room, sim: SimConfig = EXACT, seed: int = 1, truth: Truth | None = None) -> World:
    """A robot that is exactly as its file says, unless another truth is given."""
    return world_of(room, ROBOT, DRIVE, sim, StillHand(), seed, truth=truth or Truth())
