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
        self._ways: dict[str, DriveDirection] = {name: bumper.way for name, bumper in robot.of(Bumper).items()}
        self._pressed: set[str] = set()
        self._touched: dict[str, Pose] = {}
        """By bumper, the robot's place when it was pushed last, until the robot has moved away from there."""
        self._uncertain: set[str] = set()
        """Bumpers of which that place is not certain: the robot may have come nearer."""

    def covers(self, way: DriveDirection) -> list[str]:
        """Return the bumpers that meet what the robot drives into."""
        return [name for name, covered in self._ways.items() if covered == way]

    def on_sample(self, sample: Bump, motion: RecentTravel, now: RobotTime) -> Sequence[Beam]:
        """Take what one says."""
        del now
        self._pressed.discard(sample.sensor)
        if sample.pressed:
            self._pressed.add(sample.sensor)
            self._touch(sample.sensor, motion)
        return ()

    def sight(self, sensor: str, way: DriveDirection, motion: RecentTravel, now: RobotTime) -> Sight:
        """Return whether something touches it."""
        del now
        return Sight(sensor, touch=self.touch(sensor, way, motion))

    def touch(self, sensor: str, way: DriveDirection, motion: RecentTravel) -> Trouble:
        """Return why something may touch it: its last word, or where it was pushed last."""
        if sensor in self._pressed:
            return Trouble(f"{sensor} is pushed: something touches it, or its wire is cut")
        touched, away = self._touched.get(sensor), 2.0 * self.live.config.touch_distance
        if touched is None:
            return NO_TROUBLE
        if sensor in self._uncertain or not motion.heard:
            touched = self._touch(sensor, motion)
        backed = -SIGN[way] * touched.ahead(motion.place, 0.0)
        if backed >= away or abs(motion.place.yaw - touched.yaw) >= _TURNED_AWAY:
            del self._touched[sensor]
            return NO_TROUBLE
        return Trouble(f"{sensor} was pushed here, and the robot has not come {away:g} m away")

    def trouble(self, sensor: str, motion: RecentTravel, now: RobotTime) -> Trouble:
        """Return that one that is heard is trusted."""
        del sensor, motion, now
        return NO_TROUBLE

    def forget(self) -> None:
        """Begin anew. Where one was pushed something may still stand: the robot has to move away from where it is."""
        self._pressed.clear()
        self.lose_place()

    def lose_place(self) -> None:
        """Take note that the robot may have come nearer: it has to move away from where it is now."""
        self._uncertain.update(self._touched)

    def _touch(self, sensor: str, motion: RecentTravel) -> Pose:
        """Take where the robot is for where it was pushed. While no wheels are heard, that place is not certain."""
        self._touched[sensor] = motion.place
        self._uncertain.discard(sensor)
        if not motion.heard:
            self._uncertain.add(sensor)
        return motion.place
