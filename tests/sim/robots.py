"""The robots and rooms of these tests."""

import math

from giraff_node.robot import RobotConfig, SensorPose
from giraff_sim.config import SimConfig
from giraff_sim.hand import StillHand
from giraff_sim.room import Pose, Room
from giraff_sim.world import World

ROBOT = RobotConfig(
    name="sim-test",
    track_width=0.47,
    ticks_per_metre=2002.0594,
    max_wheel_speed=0.6,
    max_level=70,
    max_angular_speed=1.57,
    footprint_radius=0.3,
    battery_volts_per_count=0.03,
    swap_motors=False,
    swap_encoders=False,
    invert_left_motor=False,
    invert_right_motor=False,
    invert_left_encoder=False,
    invert_right_encoder=False,
    sensors={
        "front_left": SensorPose(index=0, x=0.25, y=0.15, yaw=0.0),
        "front_right": SensorPose(index=1, x=0.25, y=-0.15, yaw=0.0),
        "rear": SensorPose(index=2, x=-0.25, y=0.0, yaw=math.pi),
    },
)

EXACT = SimConfig(sonar_noise=0.0, tilt_noise=0.0, battery_sag_volts=0.0, battery_volts=24.0)
"""Nothing random, and a battery that holds its nominal voltage."""

ORIGIN = Pose(0.0, 0.0, 0.0)


def empty_room(start: Pose = ORIGIN) -> Room:
    return Room("empty", start)


def room_with_wall(x: float, start: Pose = ORIGIN) -> Room:
    """A wall across the x axis, 20 m wide."""
    room = empty_room(start)
    room.add_wall("wall", [(x, -10.0), (x, 10.0)])
    return room


def world_in(room: Room, sim: SimConfig = EXACT, seed: int = 1) -> World:
    return World(room, ROBOT, sim, StillHand(), seed)
