"""Where the robot was in `odom`, over the last seconds: what odometry said, and what lies between two of its words.

And since when `odom` is where it is, and why a frame cannot be told in another.
"""

import math
from bisect import bisect_left
from collections import deque
from typing import Final, NamedTuple

from giraff_core.kinematics.dead_reckoning import wrapped
from giraff_core.kinematics.pose import Pose
from giraff_schemas.messages import Odometry, RobotTime

REMEMBERED: Final = 10.0
"""s."""
LONGEST_GAP: Final = 0.5
"""s between two samples over which nobody can tell how the robot went: the default of `[odometry] max_gap`."""
_EPOCHS: Final = 16
"""Starts of base that are over, and known to be."""


class FrameError(Exception):
    """A frame cannot be told in another. The message names the cause and the way out."""


class UnknownFrameError(FrameError):
    """Nobody has told of such a frame."""


class UnconnectedError(FrameError):
    """Both frames are known, and nothing joins them."""


class PastError(FrameError):
    """The moment is before what is remembered, or of a clock that is over."""


class FutureError(FrameError):
    """Nothing of that moment, or of a later one, has been heard yet."""


class GapError(FrameError):
    """The robot did not come from the sample before that moment to the one after it, or nobody can tell how."""


class _Moment(NamedTuple):
    robot_ns: int
    pose: Pose
    segment: tuple[str, int]


class PoseHistory:
    """The newest `REMEMBERED` s of one start of base.

    Two samples of one tick count once, as the later one: telemetry comes oftener than ticks.
    """

    def __init__(self) -> None:
        self._epoch = 0
        self._over: deque[int] = deque(maxlen=_EPOCHS)
        self._moments: deque[_Moment] = deque()

    def on_odometry(self, odometry: Odometry) -> None:
        """Take a sample; one that is older than the newest says nothing new."""
        tick = odometry.tick
        if tick.epoch in self._over:
            return
        if tick.epoch != self._epoch:
            if self._moments:
                self._over.append(self._epoch)
            self._epoch = tick.epoch
            self._moments.clear()
        moments = self._moments
        if moments and tick.robot_ns < moments[-1].robot_ns:
            return
        if moments and tick.robot_ns == moments[-1].robot_ns:
            moments.pop()
        moments.append(_Moment(tick.robot_ns, Pose(odometry.x, odometry.y, odometry.yaw), odometry.segment))
        while tick.robot_ns - moments[0].robot_ns > REMEMBERED * 1e9:
            moments.popleft()

    def newest(self) -> tuple[Pose, RobotTime] | None:
        """Where the robot was last heard to be, and when; None: nothing was heard."""
        if not self._moments:
            return None
        last = self._moments[-1]
        return last.pose, RobotTime(self._epoch, last.robot_ns)

    def at(self, moment: RobotTime) -> Pose:
        """Where it was then: linear between two samples, the shortest way in yaw.

        Raises PastError, FutureError, and GapError where the robot did not come from the one sample to the other.
        """
        after = self._first_since(moment)
        later = self._moments[after]
        if later.robot_ns == moment.robot_ns:
            return later.pose
        earlier = self._moments[after - 1]
        gap = (later.robot_ns - earlier.robot_ns) / 1e9
        if earlier.segment != later.segment:
            raise GapError(
                "odometry was set, or began anew, at that moment: nobody can tell where the robot was then; "
                "take another moment"
            )
        if gap > LONGEST_GAP:
            raise GapError(
                f"odometry was not heard for {gap:.2f} s about that moment: nobody can tell where the robot was then; "
                "take another moment, and check the network"
            )
        share = (moment.robot_ns - earlier.robot_ns) / (later.robot_ns - earlier.robot_ns)
        a, b = earlier.pose, later.pose
        yaw = wrapped(a.yaw + share * math.remainder(b.yaw - a.yaw, math.tau))
        return Pose(a.x + share * (b.x - a.x), a.y + share * (b.y - a.y), yaw)

    def _first_since(self, moment: RobotTime) -> int:
        """Index of the first of the samples that is not before that moment."""
        if moment.epoch in self._over:
            raise PastError("that moment is of an earlier start of base, whose clock is over; take a newer tick")
        if moment.epoch != self._epoch or not self._moments:
            raise FutureError(
                "odometry has not been heard since the start of base that moment is of; wait for it, and check that "
                "giraff_odometry runs"
            )
        first, last = self._moments[0].robot_ns, self._moments[-1].robot_ns
        if moment.robot_ns > last:
            raise FutureError(
                f"that moment is {(moment.robot_ns - last) / 1e9:.3f} s ahead of the newest of odometry; wait for it"
            )
        if moment.robot_ns < first:
            raise PastError(
                f"that moment is {(first - moment.robot_ns) / 1e9:.3f} s before the first that is remembered; "
                f"the last {REMEMBERED:g} s are, from the first sample that was heard; take a newer tick"
            )
        return bisect_left(self._moments, moment.robot_ns, key=lambda heard: heard.robot_ns)


class Segment:
    """Since when the frame `odom` is where it is: what was found of it before says nothing of it now.

    It begins anew where odometry, base's board or the pose does.
    """

    def __init__(self) -> None:
        self._segment: tuple[str, int, int] | None = None
        self._since: RobotTime | None = None
        self._newest: RobotTime | None = None

    def on_odometry(self, odometry: Odometry) -> None:
        """Take a sample, as it arrives."""
        segment = (*odometry.segment, odometry.boot_id)
        if segment != self._segment:
            self._segment, self._since = segment, odometry.tick
        self._newest = odometry.tick

    def holds(self, tick: RobotTime | None) -> bool:
        """Whether what has this tick is of `odom` as it is now, and of this start of base."""
        since, newest = self._since, self._newest
        if tick is None or since is None or newest is None or tick.epoch != newest.epoch:
            return False
        # Odometry comes oftener than ticks: the tick of its first sample may be of the last of another segment, too.
        return tick.epoch != since.epoch or tick.robot_ns > since.robot_ns
