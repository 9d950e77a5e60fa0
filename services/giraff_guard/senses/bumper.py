"""Bumpers as a sense of the guard: one that is pushed stops its way, until the robot has moved away from there."""

import math
from collections.abc import Sequence
from typing import Final

from giraff_core.kinematics.pose import Pose
from giraff_core.live import Live
from giraff_core.robot import RobotConfig
from giraff_core.senses import Bumper
from giraff_guard.config import GuardConfig
from giraff_guard.limits import SIGN, DriveDirection
from giraff_guard.motion import RecentTravel
from giraff_guard.source import Beam, Sight, Source
from giraff_schemas.bumper import Bump
from giraff_schemas.messages import RobotTime
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_TURNED_AWAY: Final = math.pi / 2.0
"""rad, from which on a bumper of half the rim looks elsewhere."""


class BumperSource(Source):
    """All bumpers of one robot."""

    sense, sees_ahead = Bumper, False

    def __init__(self, live: Live[GuardConfig], robot: RobotConfig) -> None:
        super().__init__(live, robot)
        self._switches = {name: _Switch(name, bumper) for name, bumper in robot.of(Bumper).items()}

    def covers(self, way: DriveDirection) -> list[str]:
        """Return the bumpers that meet what the robot drives into."""
        return [name for name, switch in self._switches.items() if switch.way == way]

    def on_sample(self, sample: Bump, motion: RecentTravel, now: RobotTime) -> Sequence[Beam]:
        """Take what one says."""
        del now
        self._switches[sample.sensor].on_bump(sample, motion)
        return ()

    def sight(self, sensor: str, way: DriveDirection, motion: RecentTravel, now: RobotTime) -> Sight:
        """Return whether something touches it."""
        del way, now
        return Sight(sensor, touch=self._switches[sensor].push(motion, self.live.config.touch_distance))

    def trouble(self, sensor: str, motion: RecentTravel, now: RobotTime) -> Trouble:
        """Return that one that is heard is trusted."""
        del sensor, motion, now
        return NO_TROUBLE

    def forget(self) -> None:
        """Begin anew. Where one was pushed something may still stand: the robot has to move away from where it is."""
        for switch in self._switches.values():
            switch.forget()

    def lose_place(self) -> None:
        """Take note that the robot may have come nearer: it has to move away from where it is now."""
        for switch in self._switches.values():
            switch.lose_place()


class _Switch:
    def __init__(self, name: str, bumper: Bumper) -> None:
        self._name = name
        self.way: DriveDirection = bumper.way
        self._is_pressed = False
        self._touched: Pose | None = None
        """Where the robot was when it was pushed last, until it has moved away from there."""
        self._place_is_lost = False

    def on_bump(self, sample: Bump, motion: RecentTravel) -> None:
        self._is_pressed = sample.pressed
        if sample.pressed:
            self._touch(motion)

    def lose_place(self) -> None:
        self._place_is_lost = True

    def forget(self) -> None:
        self._is_pressed, self._place_is_lost = False, True

    def push(self, motion: RecentTravel, touch_distance: float) -> Trouble:
        """Return why something stands at it. `touch_distance`: m; twice as much is away."""
        if self._is_pressed:
            return Trouble(f"{self._name} is pushed: something touches it, or its wire is cut")
        touched = self._touched
        if touched is None:
            return NO_TROUBLE
        if self._place_is_lost or not motion.heard:
            touched = self._touch(motion)
        axis = 0.0 if SIGN[self.way] > 0.0 else math.pi
        backed = -touched.ahead(motion.place, axis)
        if backed >= 2.0 * touch_distance or abs(motion.place.yaw - touched.yaw) >= _TURNED_AWAY:
            self._touched = None
            return NO_TROUBLE
        return Trouble(f"{self._name} was pushed here, and the robot has not come {2.0 * touch_distance:g} m away")

    def _touch(self, motion: RecentTravel) -> Pose:
        """Take where the robot is for where it was pushed. While no wheels are heard, that place is not certain."""
        self._touched, self._place_is_lost = motion.place, not motion.heard
        return motion.place
