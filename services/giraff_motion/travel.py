"""What the robot has made of a motion so far, by odometry, and how sure that is."""

from __future__ import annotations

import math

from giraff_core.kinematics.calibration import Covariance
from giraff_core.kinematics.dead_reckoning import Estimate, advance, chord_ratio
from giraff_core.kinematics.pose import Pose
from giraff_core.kinematics.systematic_error import SystematicError
from giraff_core.robot import RobotConfig
from giraff_schemas.messages import Odometry
from giraff_schemas.motion import Displacement


class Travel:
    """Begins at one sample of odometry, without doubt: what it errs by later is what has come to it on this way.

    The way of each wheel is told from two poses, as if it had been an arc, and makes the same covariance of it that
    odometry makes.
    """

    def __init__(self, robot: RobotConfig, start: Odometry) -> None:
        self.start = Pose(start.x, start.y, start.yaw)
        self.pose = self.start
        """In `odom`; its yaw counts whole turns from here on."""
        self._path = 0.0
        self._drive, self._wheel_noise = robot.kinematics, robot.wheel_noise
        self._random = Estimate()
        self._systematic = SystematicError(robot.calibration, robot.kinematics)

    def add(self, odometry: Odometry) -> None:
        """Go on to a later sample of the same segment."""
        last = self.pose
        turn = math.remainder(odometry.yaw - last.yaw, math.tau)
        self.pose = Pose(odometry.x, odometry.y, last.yaw + turn)
        distance = last.ahead(self.pose, turn / 2.0) / chord_ratio(turn)
        self._path += distance
        left, right = self._drive.wheel_speeds(distance, turn)
        self._random = advance(self._random, left, right, self._drive, self._wheel_noise)
        self._systematic.advance(left, right)

    @property
    def displacement(self) -> Displacement:
        """From the start, seen from there."""
        x, y = self.start.sees(self.pose.x, self.pose.y)
        return Displacement(path=self._path, x=x, y=y, yaw=self.pose.yaw - self.start.yaw)

    @property
    def covariance(self) -> Covariance:
        """Of its x, y and yaw."""
        both = zip(self._random.covariance, self._systematic.covariance(), strict=True)
        xx, xy, xt, yy, yt, tt = (one + other for one, other in both)
        return xx, xy, xt, yy, yt, tt
