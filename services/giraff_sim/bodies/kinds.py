"""The world around a robot of each kind."""

from __future__ import annotations

from giraff_base.config import DriveConfig
from giraff_core.robot import RobotConfig
from giraff_sim.bodies.wheels.body import WheelsBody
from giraff_sim.config import SimConfig
from giraff_sim.truth import EXACT, Truth
from giraff_sim.world.hand import Hand
from giraff_sim.world.room import Room
from giraff_sim.world.world import STEP_US, World


def world_of(
    room: Room,
    robot: RobotConfig,
    drive: DriveConfig,
    sim: SimConfig,
    hand: Hand,
    seed: int,
    step_us: int = STEP_US,
    truth: Truth = EXACT,
) -> World:
    """Set the robot of the file at rest at the room's start."""
    return World(room, robot, WheelsBody(robot, drive, sim, room, truth), sim, hand, seed, step_us, truth)
