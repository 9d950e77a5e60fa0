"""What scales of wheels and track that are not exactly known do to the pose.

They are the same on the whole way, so that their errors do not average out as those of the wheels' slip do; and on a
closed path they cancel to first order, so that Jacobians say too little there. Six robots are carried along instead,
each with scales of its own that the calibration holds for as likely (`Calibration.sigma_points`): what they are apart
is the error. S. Julier, J. Uhlmann, Unscented Filtering and Nonlinear Estimation, Proceedings of the IEEE 92 (2004).
"""

import math
from typing import NamedTuple

from giraff_core.kinematics.calibration import Calibration, Covariance
from giraff_core.kinematics.dead_reckoning import chord_ratio
from giraff_core.kinematics.differential_drive import DifferentialDrive
from giraff_core.kinematics.pose import Pose


class _Factors(NamedTuple):
    """On what the robot is taken for."""

    left: float
    right: float
    track: float


class SystematicError:
    """Follows one robot from where it was last known."""

    def __init__(self, calibration: Calibration, drive: DifferentialDrive) -> None:
        """`drive`: with the track that was found."""
        self._drive = drive
        found = calibration.scales
        self._factors = [
            _Factors(*(one / other for one, other in zip(point, found, strict=True)))
            for point in calibration.sigma_points()
        ]
        self._found = _Factors(1.0, 1.0, 1.0)
        self.begin(Pose(0.0, 0.0, 0.0))

    def begin(self, pose: Pose) -> None:
        """The robot is known to be at `pose`."""
        self._here = pose
        self._others = [pose] * len(self._factors)

    def advance(self, left: float, right: float) -> None:
        """Its wheels have travelled so many m, by the scales that were found."""
        if left == right == 0.0:
            return
        self._here = self._moved(self._here, left, right, self._found)
        self._others = [
            self._moved(pose, left, right, factors) for pose, factors in zip(self._others, self._factors, strict=True)
        ]

    def covariance(self) -> Covariance:
        """Of (x, y, yaw): xx, xy, xyaw, yy, yyaw, yawyaw, about the robot with the scales that were found."""
        xx = xy = xt = yy = yt = tt = 0.0
        here = self._here
        for other in self._others:
            x, y, yaw = other.x - here.x, other.y - here.y, other.yaw - here.yaw
            xx, xy, xt = xx + x * x, xy + x * y, xt + x * yaw
            yy, yt, tt = yy + y * y, yt + y * yaw, tt + yaw * yaw
        count = len(self._others)
        return xx / count, xy / count, xt / count, yy / count, yt / count, tt / count

    def _moved(self, pose: Pose, left: float, right: float, factors: _Factors) -> Pose:
        """Yaw goes on past half a turn: what two robots are apart is more than that after some turns."""
        distance, turn = self._drive.twist(left * factors.left, right * factors.right)
        turn /= factors.track
        chord, middle = distance * chord_ratio(turn), pose.yaw + turn / 2.0
        return Pose(pose.x + chord * math.cos(middle), pose.y + chord * math.sin(middle), pose.yaw + turn)
