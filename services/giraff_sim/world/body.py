"""A robot's body, as the world sees it, whatever moves it."""

from __future__ import annotations

from typing import Protocol

from giraff_sim.board import Board
from giraff_sim.world.room import Pose


class RollingWheel(Protocol):
    """One of two wheels."""

    speed: float
    """m/s of its true rim, forward positive."""


class Plant(Protocol):
    """The true motion of a body that stands on two wheels, and its battery."""

    pose: Pose
    speed: float
    """m/s at which the wheels carry the centre, forward positive."""
    turn: float
    """rad/s at which they turn the body, counter-clockwise positive."""
    path_length: float
    """m the centre has moved."""
    contacts: int
    """How often the body came to touch something."""
    open_volts: float
    """V of the battery with nothing connected."""
    volts: float
    """V of the battery now."""

    @property
    def left(self) -> RollingWheel: ...

    @property
    def right(self) -> RollingWheel: ...

    @property
    def clearance(self) -> float:
        """m between the body and what is nearest to it."""
        ...

    @property
    def closest(self) -> float:
        """The smallest clearance so far, m."""
        ...

    def place(self, pose: Pose) -> None:
        """Lift the robot and set it down at rest."""
        ...


class BoardReport(Protocol):
    """What each base board's report has."""

    @property
    def boot_id(self) -> int: ...

    @property
    def accepted(self) -> int: ...

    @property
    def refused(self) -> int: ...


class Body(Protocol):
    """One kind of robot, between its base board's pins and the floor."""

    @property
    def report(self) -> type[BoardReport]:
        """The frame in which its board reports."""
        ...

    @property
    def acts(self) -> str:
        """A word for what it does outside its safe state, in texts."""
        ...

    @property
    def settles_us(self) -> int:
        """us. Time that it needs to reach its safe state, once nothing else is asked of it."""
        ...

    @property
    def plant(self) -> Plant: ...

    @property
    def activity(self) -> int:
        """0 when it was in its safe state throughout the last step; else a positive number of its own unit."""
        ...

    def step(self, board: Board | None, duration: float) -> None:
        """Move for `duration` s by what the board's pins gave since the last step, and set its sensors' pins."""
        ...

    def look(self, board: Board) -> None:
        """Find `activity`. The board has just run."""
        ...
