"""The way of the robot, whatever becomes of the frame `odom`: what lies between two samples of odometry is its motion.

It is followed in a frame of its own, in which the robot never jumps. A reading is put to where the robot was when it
was taken.
"""

import math
from bisect import bisect_left
from collections import deque
from typing import Final, NamedTuple

from giraff_core.kinematics.pose import Pose
from giraff_schemas.messages import Odometry, RobotTime

_REMEMBERED: Final = 400
"""Samples: four seconds."""
_SOON: Final = 2.0
"""s by which a reading may be ahead of odometry."""
_LONGEST_GAP: Final = 0.5
"""s between two samples over which nobody can tell where a reading was taken."""
_TURNING: Final = 0.1
"""m of way that a radian counts for."""

_DRIFT: Final = 0.3
_SPIN: Final = 0.5
"""m/s, rad/s: how far a robot may have come, as a standard deviation, while odometry was being started again."""
_LONGEST_START: Final = 5.0
"""s of it that count."""
_OVERTAKEN: Final = 1000
"""Samples by which an old one may come late: one that is farther back is of another count."""
_LEAP: Final = 5.0
"""m between two samples that are no motion of a robot."""
_MOST_MISSED: Final = 5.0
"""m, or rad up to π, of what counts: who has missed more may be anywhere about."""
_SOMETHING: Final = 0.05
"""m or rad, of what was missed, that does not wait for the next stride."""


class Stride(NamedTuple):
    """How the robot has moved from one update to the next."""

    x: float
    """m; where it is now, seen from where it was."""
    y: float
    turn: float
    """rad, whole turns counted."""
    forward: float
    """m along the way, backward counted negative."""
    way: float
    """m along the way."""
    turned: float
    """rad, either side."""
    missed: tuple[float, float]
    """m (on either axis) and rad: standard deviations of what odometry says that it has missed."""

    @property
    def effort(self) -> float:
        """m of way, turns counted."""
        return self.way + _TURNING * self.turned


class _Moment(NamedTuple):
    epoch: int
    robot_ns: int
    pose: Pose


class Track:
    """Poses here are of the frame in which the robot began."""

    def __init__(self) -> None:
        self.pose = Pose(0.0, 0.0, 0.0)
        """Its yaw counts whole turns."""
        self.last: Odometry | None = None
        self._moments: deque[_Moment] = deque(maxlen=_REMEMBERED)
        self._begin()

    def on_odometry(self, odometry: Odometry) -> None:
        """Take a sample; one that is older than the newest says nothing."""
        last = self.last
        if last is not None and last.instance == odometry.instance and 0 < last.seq - odometry.seq < _OVERTAKEN:
            return
        self.last = odometry
        if last is not None:
            self._advance(last, odometry)
        tick = odometry.tick
        moments = self._moments
        if moments and (moments[-1].epoch != tick.epoch or moments[-1].robot_ns > tick.robot_ns):
            moments.clear()
        if moments and moments[-1].robot_ns == tick.robot_ns:
            moments.pop()
        moments.append(_Moment(tick.epoch, tick.robot_ns, self.pose))

    def is_ahead(self, moment: RobotTime) -> bool:
        """Whether odometry of that moment is still to come, and soon."""
        if not self._moments:
            return True
        last = self._moments[-1]
        return last.epoch == moment.epoch and 0 < moment.robot_ns - last.robot_ns < _SOON * 1e9

    def at(self, moment: RobotTime) -> Pose | None:
        """Where the robot was then, linear between two samples; None: nobody can tell."""
        moments = self._moments
        if not moments or moments[-1].epoch != moment.epoch or moments[0].robot_ns > moment.robot_ns:
            return None
        after = bisect_left(moments, moment.robot_ns, key=lambda each: each.robot_ns)
        if after == len(moments):
            return None
        later = moments[after]
        if later.robot_ns == moment.robot_ns:
            return later.pose
        earlier = moments[after - 1]
        gap_ns = later.robot_ns - earlier.robot_ns
        if gap_ns > _LONGEST_GAP * 1e9:
            return None
        share = (moment.robot_ns - earlier.robot_ns) / gap_ns
        return Pose(*(one + share * (other - one) for one, other in zip(earlier.pose, later.pose, strict=True)))

    @property
    def way(self) -> float:
        """m since the last `pop_stride`."""
        return self._way

    @property
    def turned(self) -> float:
        """rad, either side, since the last `pop_stride`."""
        return self._turned

    @property
    def has_missed(self) -> bool:
        """Whether odometry has missed something since then that matters."""
        return max(self._position_variance, self._yaw_variance) > _SOMETHING**2

    def pop_stride(self) -> Stride:
        """What has come together since the last time."""
        here = self.pose.seen_from(self._start)
        stride = Stride(
            here.x,
            here.y,
            self.pose.yaw - self._start.yaw,
            self._forward,
            self._way,
            self._turned,
            (
                min(_MOST_MISSED, math.sqrt(self._position_variance)),
                min(math.pi, math.sqrt(self._yaw_variance)),
            ),
        )
        self._begin()
        return stride

    def _begin(self) -> None:
        self._start = self.pose
        self._forward = self._way = self._turned = 0.0
        self._position_variance = self._yaw_variance = 0.0

    def _advance(self, last: Odometry, odometry: Odometry) -> None:
        if last.instance != odometry.instance:
            self._restart(last, odometry)
            return
        if last.jumps != odometry.jumps:
            return  # the pose was set: the robot has not moved
        before = Pose(last.x, last.y, last.yaw)
        if math.dist(before[:2], (odometry.x, odometry.y)) > _LEAP:
            self._restart(last, odometry)
            return
        step = Pose(odometry.x, odometry.y, odometry.yaw).seen_from(before)
        forward = math.hypot(step.x, step.y) * math.copysign(1.0, step.x)
        moved = Pose(step.x, step.y, step.yaw).placed_in(self.pose)
        self.pose = Pose(moved.x, moved.y, self.pose.yaw + step.yaw)
        self._forward += forward
        self._way += abs(forward)
        self._turned += abs(step.yaw)
        if odometry.breaks != last.breaks:
            self._note_missed(last, odometry)

    def _note_missed(self, last: Odometry, odometry: Odometry) -> None:
        """What the covariance has grown by in this one sample."""
        xx, _, _, yy, _, tt = (new - old for new, old in zip(odometry.covariance, last.covariance, strict=True))
        self._position_variance += max(0.0, (xx + yy) / 2.0)
        self._yaw_variance += max(0.0, tt)

    def _restart(self, last: Odometry, odometry: Odometry) -> None:
        """Odometry was started again, or says what cannot be: where the robot went meanwhile, nobody knows."""
        gap = _LONGEST_START
        if last.tick.epoch == odometry.tick.epoch:
            gap = min(gap, abs(odometry.tick.robot_ns - last.tick.robot_ns) / 1e9)
        self._position_variance += (_DRIFT * gap) ** 2
        self._yaw_variance += (_SPIN * gap) ** 2
