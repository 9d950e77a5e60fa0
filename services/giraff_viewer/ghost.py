"""Where a simulated robot truly is, beside where odometry has it."""

from __future__ import annotations

from collections import deque
from typing import Final

from giraff_core.kinematics.pose import Pose
from giraff_schemas.messages import Odometry, RobotTime, TruePose

_KEPT: Final = 100  # odometry samples: a second, more than a true pose is late


class Ghost:
    """Compares both at the same moment: they are not heard at the same one, and the robot drives between."""

    def __init__(self) -> None:
        self._samples: deque[Odometry] = deque(maxlen=_KEPT)

    def hear(self, odometry: Odometry) -> None:
        """Odometry's newest sample. One that was restarted, or whose pose was set, has another frame from there on."""
        if self._samples and self._samples[-1].origin != odometry.origin:
            self._samples.clear()
        self._samples.append(odometry)

    def at(self, tick: RobotTime | None) -> Odometry | None:
        """Return odometry of a moment of the last second; None: it says nothing of that time."""
        of_its_time = [sample for sample in self._samples if tick is not None and sample.tick.epoch == tick.epoch]
        if tick is None or not of_its_time or tick.robot_ns < of_its_time[0].tick.robot_ns:
            return None
        return min(of_its_time, key=lambda sample: abs(sample.tick.robot_ns - tick.robot_ns))

    def apart(self, truth: TruePose) -> Pose | None:
        """The true robot in the `base_link` of odometry; None: odometry says nothing of that time."""
        if (then := self.at(truth.tick)) is None:
            return None
        return Pose(truth.x, truth.y, truth.yaw).seen_from(Pose(then.x, then.y, then.yaw))
