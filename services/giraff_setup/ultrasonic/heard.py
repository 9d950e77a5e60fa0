"""The pings of a robot with its pose at each, from samples as they come. No I/O and no clock."""

from __future__ import annotations

from typing import Final

from giraff_core.kinematics.frame_errors import FutureError, GapError, PastError
from giraff_core.kinematics.pose import Pose
from giraff_core.kinematics.pose_history import PoseHistory
from giraff_schemas.messages import Lease, Odometry, Range, Sample
from giraff_schemas.services import MOTION
from giraff_schemas.wire import ECHO_US_PER_M
from giraff_setup.ultrasonic.fit import Echo

_MOST_WAITING: Final = 200
"""Pings whose pose has not come yet."""


class Hearing:
    """Puts pings and odometry together by the robot's clock."""

    def __init__(self) -> None:
        self._history = PoseHistory()
        self._waiting: list[Range] = []
        self._segment: tuple[object, ...] | None = None
        self.echoes: list[Echo] = []
        """In the order in which they came. Whoever uses them takes them away."""
        self.fault = ""
        """Reason why poses before and after do not belong together; empty: they do."""
        self.motion_holds_lease = False

    @property
    def place(self) -> Pose | None:
        """The newest pose; None: none was heard."""
        newest = self._history.newest()
        return None if newest is None else newest[0]

    def on_sample(self, sample: Sample) -> None:
        """Take a sample of odometry, of a sensor, or of the lease."""
        if isinstance(sample, Odometry):
            segment = (sample.segment, sample.breaks, sample.tick.epoch)
            if self._segment not in {None, segment}:
                self.fault = "odometry was set, began anew or lost the wheels meanwhile; begin again"
            self._segment = segment
            self._history.on_odometry(sample)
        elif isinstance(sample, Range):
            self._waiting = [*self._waiting, sample][-_MOST_WAITING:]
        elif isinstance(sample, Lease):
            self.motion_holds_lease = sample.operator == MOTION.name
        self._waiting = [each for each in self._waiting if not self._settle(each)]

    def _settle(self, reading: Range) -> bool:
        """Add a ping whose pose is known; return whether it need not wait any longer."""
        if reading.tick is None:
            return True
        try:
            at = self._history.at(reading.tick)
        except FutureError:
            return False
        except (GapError, PastError):
            return True
        far = reading.echo_us / ECHO_US_PER_M if reading.state == "echo" else None
        self.echoes.append(Echo(reading.sensor, far, at))
        return True
