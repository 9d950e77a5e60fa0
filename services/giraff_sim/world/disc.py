"""The robot's outline in its room: a disc that walls and posts stop."""

import math
from typing import Final

from giraff_sim.world.room import Pose, Room

_PUSHES: Final = 4  # out of surfaces in one step: two walls of a corner, and once more each


class Disc:
    """Moves a disc through a room. Surfaces stop it. It slides along them."""

    def __init__(self, room: Room, radius: float) -> None:
        self.pose = room.start
        self.path_length = 0.0
        """m the centre has moved."""
        self.lean = 0.0
        """rad from the vertical, forward positive."""
        self.pivot = 0.0
        """m above the floor of the axle about which it leans."""
        self.contacts = 0
        """How often the body came to touch something."""
        self._radius = radius
        self._room = room
        self._touching = False
        self._closest = math.inf
        self._clear_for = 0.0  # m that the centre may move before the closest approach can change
        self._room_version = -1

    @property
    def clearance(self) -> float:
        """m between the body and what is nearest to it."""
        return self._room.clearance(self.pose.x, self.pose.y) - self._radius

    @property
    def closest(self) -> float:
        """The smallest clearance so far, m."""
        return min(self._closest, self.clearance)

    def place(self, pose: Pose) -> None:
        """Lift the robot and set it down at rest. The path driven stays; the closest approach starts anew."""
        if not all(math.isfinite(value) for value in pose):
            raise ValueError(f"a robot cannot be at {tuple(pose)}")
        self.pose = pose
        self._touching = False
        self._closest = math.inf
        self._clear_for = 0.0

    def _move(self, distance: float, angle: float) -> None:
        middle = self.pose.yaw + angle / 2.0
        x = self.pose.x + distance * math.cos(middle)
        y = self.pose.y + distance * math.sin(middle)
        self._clear_for -= abs(distance)
        if self._clear_for <= 0.0 or self._room.version != self._room_version:
            x, y = self._stop_at_surfaces(x, y)
        self.path_length += math.hypot(x - self.pose.x, y - self.pose.y)
        self.pose = Pose(x, y, math.remainder(self.pose.yaw + angle, math.tau))

    def _stop_at_surfaces(self, x: float, y: float) -> tuple[float, float]:
        touching = False
        clearance = math.inf
        for _ in range(_PUSHES):
            distance, normal_x, normal_y = self._room.nearest(x, y)
            clearance = distance - self._radius
            if clearance >= 0.0:
                break
            touching = True
            x -= clearance * normal_x
            y -= clearance * normal_y
        if touching and not self._touching:
            self.contacts += 1
        # A robot that is pushed along a wall has left it only when it is a millimetre away.
        self._touching = touching or (self._touching and clearance < 1e-3)
        self._closest = min(self._closest, max(0.0, 0.0 if touching else clearance))
        self._clear_for = 0.0 if self._touching else max(0.0, clearance - self._closest)
        self._room_version = self._room.version
        return x, y
