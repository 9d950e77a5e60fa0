"""A sense of the guard: what sensors of one type tell of the way. The judge makes limits of that evidence."""

import math
from abc import ABC, abstractmethod
from collections.abc import Collection, Sequence
from typing import Any, ClassVar, NamedTuple

from giraff_core.kinematics.pose import Pose
from giraff_core.live import Live
from giraff_core.robot import RobotConfig
from giraff_core.senses import PUBLISHERS, SENSED, Sense
from giraff_guard.config import GuardConfig
from giraff_guard.geometry import Point
from giraff_guard.limits import DriveDirection
from giraff_guard.motion import RecentTravel
from giraff_schemas.messages import RobotTime
from giraff_schemas.trouble import NO_TROUBLE, Trouble


class Beam(NamedTuple):
    """One look of a sensor along a line. The judge remembers what answered."""

    sensor: str
    mount: Pose
    """Place and axis of the sensor in `base_link`: m, m, rad."""
    half_cone: float
    """rad off the axis from which an answer may come."""
    robot_ns: int
    place: Pose
    """Place of the robot at that moment."""
    distance: float
    """m up to which nothing is nearer."""
    is_echo: bool
    """Something answered from there."""
    is_repeated: bool = False
    """An earlier look shows the same surface."""
    is_sure: bool = False
    """The look just before shows it."""


class Reading(NamedTuple):
    """How much room one look of a sensor leaves in a direction."""

    gap: float
    """m between the footprint and what the sensor saw, at the least and at the moment of the look."""
    came: float
    """m that the robot has come nearer since."""
    distance: float
    """m from the sensor, as a person is told it."""
    is_echo: bool = True
    """Something answered. False: nothing is nearer."""


class Points(NamedTuple):
    """Points that a sensor sees now, of which the judge asks what the footprint meets."""

    xy: Sequence[Point]
    """In the frame of `RecentTravel.place`."""
    spread: float
    """m around a point within which the thing itself may be."""
    reach: float
    """m from the robot's middle. Something farther away may be unseen, so the robot drives as if it stood there."""
    place: Pose
    """Place of the robot at the moment of the newest look."""


class Sight(NamedTuple):
    """What one sensor tells of one direction. One that sees ahead gives `readings` or `points`, or says why not."""

    sensor: str
    blind: Trouble = NO_TROUBLE
    """Why it tells nothing, which blocks the direction."""
    touch: Trouble = NO_TROUBLE
    """Why something may touch the robot there, which blocks the direction."""
    readings: Sequence[Reading] = ()
    """Those that count, the newest first."""
    points: Points | None = None
    """Instead of `readings`, for a sensor that tells places."""
    doubt: Trouble = NO_TROUBLE
    """Why its silence is worth less than an answer."""
    doubtful_speed: float = math.inf
    """m/s that its silence allows."""
    silent_s: float | None = None
    """s since the last answer of one that hears nothing now and may be deaf; None: it hears, or cannot be deaf."""
    aside: float = 0.0
    """m that it sits to the left of the middle."""
    newest: float | None = None
    """m of the newest look, by which the freer side is told."""


class Source(ABC):
    """All sensors of one type. It is pure: samples, the robot's travel and the time are arguments."""

    sense: ClassVar[type[Sense]]
    """Type of its sensors in the robot file."""
    sees_ahead: ClassVar[bool]
    """It tells a distance before the robot touches anything. False: it feels a touch, or sees an edge below it."""

    def __init__(self, live: Live[GuardConfig], robot: RobotConfig) -> None:
        self.live = live
        self.names: Collection[str] = tuple(robot.of(self.sense))
        """Its sensors."""
        self.takes = SENSED[self.sense].schema
        """Sample of its sensors."""
        self.service = PUBLISHERS[self.sense.type_name()]
        """Service that publishes the samples."""

    @abstractmethod
    def covers(self, way: DriveDirection) -> Sequence[str]:
        """Return the names of the sensors that tell something of a direction. It is always the same."""

    @abstractmethod
    def on_sample(self, sample: Any, motion: RecentTravel, now: RobotTime) -> Sequence[Beam]:
        """Take a fresh sample of one sensor, newer than the last. Return what the judge remembers of it."""

    @abstractmethod
    def sight(self, sensor: str, way: DriveDirection, motion: RecentTravel, now: RobotTime) -> Sight:
        """Return what a sensor that was heard lately tells of a direction, once a decision."""

    def touch(self, sensor: str, way: DriveDirection, motion: RecentTravel) -> Trouble:
        """Return why something may touch the robot there, which counts on while the sensor is silent."""
        del sensor, way, motion
        return NO_TROUBLE

    @abstractmethod
    def trouble(self, sensor: str, motion: RecentTravel, now: RobotTime) -> Trouble:
        """Return why a sensor that was heard lately does not count, or why its silence does not."""

    @abstractmethod
    def forget(self) -> None:
        """Begin anew, in another epoch of the robot's clock and another frame of its places.

        Nothing has a known age now. The robot must still move away from what touches it.
        """

    def lose_place(self) -> None:  # noqa: B027  most senses keep no place
        """Take note that the robot's place is lost: the wheels could not be followed."""
