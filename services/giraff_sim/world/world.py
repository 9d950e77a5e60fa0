"""The world around the boards, in steps of a millisecond of simulated time: room, body, sensors, the hand."""

import math
from typing import Final

from giraff_core.robot import RobotConfig
from giraff_core.senses import Bumper as MountedBumper
from giraff_core.senses import Ultrasonic
from giraff_sim.board import Board
from giraff_sim.config import SimConfig
from giraff_sim.truth import Truth
from giraff_sim.world.bno055 import Vector
from giraff_sim.world.body import Body
from giraff_sim.world.hand import LEVEL, Hand, Tremor
from giraff_sim.world.room import Pose, Room, RoomError
from giraff_sim.world.sonar import SILENT_US, Lean, sonars

_GIVES: Final = 2e-3  # m outside the body at which something begins to push


class Bumper:
    """A switch behind one half of the rim. It is closed until something pushes there, and open without its wire."""

    def __init__(self, mount: MountedBumper, radius: float, room: Room) -> None:
        """`radius`: m, of the robot's disc."""
        self.is_cut = False
        """Its wire is cut."""
        self._side = 1.0 if mount.way == "forward" else -1.0
        self._reach = radius + _GIVES
        self._room = room

    def is_open(self, robot: Pose) -> bool:
        """Return what the board's pin reads with the robot at `robot`."""
        return self.is_cut or self._is_pushed(robot)

    def _is_pushed(self, robot: Pose) -> bool:
        room, x, y = self._room, robot.x, robot.y
        if room.clearance(x, y) > self._reach:
            return False
        ahead_x, ahead_y = self._side * math.cos(robot.yaw), self._side * math.sin(robot.yaw)
        for surface in room.surfaces:
            if room.distance(surface, x, y) <= self._reach:
                touched_x, touched_y = room.nearest_of(surface, x, y)
                if (touched_x - x) * ahead_x + (touched_y - y) * ahead_y > 0.0:
                    return True
        return False


STEP_US: Final = 1000
_EMPTIES_BY: Final = 0.2  # of its V, from full to where most cut off
HAND_US: Final = 8000
"""What the hand does acts from a multiple of this on: the accelerometer takes no more samples than one in that time."""


class World:
    """Everything that is not a board. The same seed makes the same world."""

    def __init__(
        self,
        room: Room,
        robot: RobotConfig,
        body: Body,
        sim: SimConfig,
        hand: Hand,
        seed: int,
        step_us: int,
        truth: Truth,
    ) -> None:
        """Set the robot at rest at the room's start.

        `robot`: what is believed of it; `truth`: how it differs from what that says it was built as.
        `step_us`: of simulated time; divides 8000.
        """
        self.room = room
        self.truth = truth
        self.body = body
        self.plant = body.plant
        if self.plant.clearance < 0.0:
            radius = robot.footprint_radius
            raise RoomError(f"room {room.name!r}: the robot, a disc of {radius:g} m, does not fit at its start")
        self.sonars = sonars(robot.of(Ultrasonic), room, sim, seed, truth)
        mounts = robot.of(MountedBumper).values()
        self.bumpers = {mount.index: Bumper(mount, robot.footprint_radius, room) for mount in mounts}
        """By their number on the ranger board."""
        self.hand = hand
        self._tremor = Tremor(sim.hand_tremor, seed)
        self.acceleration: Vector = LEVEL
        """m/s^2 that truly act on the joystick; its sensor reads them with an offset of its own."""
        self.button = False
        """Whether the joystick's button is pressed."""
        self.now_us = 0
        self.skew = 0.0
        """s by which this world's time has slipped behind the wall's. Clocks of real devices do not slip."""
        self.sim = sim
        self.seed = seed
        self.step_us = step_us
        steps = sim.battery_hours * 3600e6 / step_us
        self._volts_per_step = _EMPTIES_BY * self.plant.open_volts / steps if steps else 0.0

    def step(self, base: Board | None) -> None:
        """Advance by `step_us`, with the pins of the base board, where there is one."""
        if self.now_us % HAND_US == 0:
            self._feel(self.now_us * 1e-6)
        self.now_us += self.step_us
        if self._volts_per_step:
            self.plant.open_volts = max(0.0, self.plant.open_volts - self._volts_per_step)
        self.body.step(base, self.step_us * 1e-6)

    def _feel(self, seconds: float) -> None:
        vector = self.hand.acceleration(seconds, self.plant.pose)
        self.acceleration = self._tremor.added_to(vector, seconds) if self.hand.trembles else vector

    def echo_us(self, number: int) -> float:
        """The echo pulse of the sensor that was just triggered, as board_model.h has it."""
        sonar = self.sonars.get(number)
        return SILENT_US if sonar is None else sonar.echo_us(self.plant.pose, Lean(self.plant.lean, self.plant.pivot))
