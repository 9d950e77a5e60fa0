"""A sense of the guard: what it allows in a direction and why, and how blind it is."""

from collections.abc import Mapping
from typing import Any, Protocol

from giraff_guard.limits import DriveDirection
from giraff_guard.motion import RecentTravel
from giraff_schemas.messages import DirectionLimit, RobotTime, Sample
from giraff_schemas.trouble import Trouble


class Source(Protocol):
    """All sensors of one type. It is pure: what is heard, where the robot is and what time it is are arguments."""

    @property
    def takes(self) -> type[Sample]:
        """What its sensors say."""
        ...

    @property
    def names(self) -> Mapping[str, object]:
        """The names of its sensors."""
        ...

    def on_sample(self, sample: Any, motion: RecentTravel, now: RobotTime) -> None:
        """A fresh sample of one of its sensors, newer than the last, of the one process that may tell it."""
        ...

    def forget(self) -> None:
        """Begin anew, in another epoch of the robot's clock and another frame of its places.

        Nothing has a known age now; what must be moved away from has to be so all the same.
        """
        ...

    def lose_place(self) -> None:
        """Nobody knows where the robot has come to: the wheels could not be followed."""
        ...

    def straight(self, way: DriveDirection, motion: RecentTravel, now: RobotTime) -> DirectionLimit:
        """For driving straight, once a decision. One that is blind blocks its way, or lets the robot creep."""
        ...

    def curve(
        self, way: DriveDirection, curvature: float, motion: RecentTravel, now: RobotTime
    ) -> tuple[float, Trouble] | None:
        """m/s and why, where a curve (angular_z / linear_x, 1/m) meets what straight ahead does not; None: nowhere."""
        ...

    def room(self, way: DriveDirection, motion: RecentTravel, now: RobotTime) -> float:
        """Return m beyond the footprint that are known to be free on this side; 0 where that is not known."""
        ...

    def turn(self, motion: RecentTravel) -> DirectionLimit | None:
        """For turning in place; None: nothing is in its way."""
        ...

    def relied_on(self, way: DriveDirection, now: RobotTime) -> RobotTime | None:
        """The oldest of the newest moments that driving this way relies on, robot_ns 0 for one that never came."""
        ...

    def troubles(self, motion: RecentTravel, now: RobotTime) -> dict[str, Trouble]:
        """By sensor: why it is not trusted."""
        ...

    def freer_side(self, way: DriveDirection) -> str:
        """Where a blocked robot may turn to: left, right, or empty."""
        ...
