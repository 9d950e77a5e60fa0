"""Switches at the robot's rim, among the surfaces of a room. SI units."""

from __future__ import annotations

import math
from typing import Final

from giraff_core.sensors import Bumper as MountedBumper
from giraff_sim.world.room import Pose, Room

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
