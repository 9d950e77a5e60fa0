"""Where the wheels had the robot at the moment of a picture."""

from __future__ import annotations

from collections import deque
from typing import Final, NamedTuple

from giraff_core.kinematics.pose import Pose
from giraff_schemas.messages import Odometry, RobotTime

_KEPT: Final = 500
"""Samples: 5 s of them, longer than a picture takes to come."""
_GAP: Final = 0.1
"""s by which a picture may be newer than the newest sample before it: the robot goes on meanwhile as it did then."""


class Whereabouts(NamedTuple):
    """Of the wheels at one moment."""

    segment: tuple[int, str, int]
    """Between two of which this differs lies no motion."""
    pose: Pose
    """In `odom`."""
    speed: float
    """m/s."""
    turn: float
    """rad/s."""


class WheelPath:
    """What odometry has said in the last seconds."""

    def __init__(self) -> None:
        self._samples: deque[Odometry] = deque(maxlen=_KEPT)

    def add(self, sample: Odometry) -> None:
        """Take the next sample. An older one than the last is passed over."""
        last = self._samples[-1] if self._samples else None
        if last is not None and _segment(last) != _segment(sample):
            self._samples.clear()
        elif last is not None and sample.tick.robot_ns <= last.tick.robot_ns:
            return
        self._samples.append(sample)

    def at(self, tick: RobotTime | None, since_tick: float) -> Whereabouts | None:
        """Return where the wheels had the robot `since_tick` s after a tick; None: they do not tell."""
        if tick is None or not self._samples or tick.epoch != self._samples[-1].tick.epoch:
            return None
        moment = tick.robot_ns + round(since_tick * 1e9)
        before = next((each for each in reversed(self._samples) if each.tick.robot_ns <= moment), None)
        if before is None:
            return None
        seconds = (moment - before.tick.robot_ns) * 1e-9
        if seconds > _GAP:
            return None
        pose = Pose(before.x, before.y, before.yaw).moved(before.linear_x * seconds, before.angular_z * seconds)
        return Whereabouts(_segment(before), pose, before.linear_x, before.angular_z)


def _segment(sample: Odometry) -> tuple[int, str, int]:
    return sample.tick.epoch, *sample.segment
