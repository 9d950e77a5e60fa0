"""A recording through localization: what it says to it, and how far off that is where the truth is known.

Pure: no network, no clock, no files.
"""

from __future__ import annotations

from typing import Final

from giraff_cli.localize.client import told_pose
from giraff_core.kinematics.pose import Pose
from giraff_localization.policy import LocalizationPolicy
from giraff_schemas.messages import Odometry, Range, Sample, TruePose
from giraff_schemas.topics import POSE
from giraff_sim.world.room import Room
from giraff_telemetry.localization import WayByState
from giraff_telemetry.localization_error import LocalizationErrors

_POSE_EVERY_NS: Final = round(1e9 / POSE.rate_hz)
_NEAREST: Final = 0.02  # m: the centre of a robot is never so near to a wall


class TrueWay:
    """Where a simulated robot truly was on the map: `true_pose` is in `odom`, which began where the room says.

    That holds only as long as odometry is the one that began there, and its pose was never set.
    """

    def __init__(self, room: Room | None) -> None:
        """`room`: that the map is of; None: it is of none, and has no start."""
        self._room = room
        self._segment: tuple[str, int] | None = None
        self.doubt = "" if room is not None else "this map does not say where a run starts on it"
        """Why nothing can be told of it; empty: nothing speaks against it."""

    def on_odometry(self, odometry: Odometry) -> None:
        """Each in turn."""
        segment = odometry.segment
        if odometry.jumps or (self._segment is not None and segment != self._segment):
            self.doubt = self.doubt or "odometry began anew on the way, or its pose was set"
        self._segment = segment

    def on_map(self, pose: TruePose) -> Pose | None:
        """Where that is; None: it cannot be told."""
        if self._room is None or self.doubt:
            return None
        true = Pose(pose.x, pose.y, pose.yaw).placed_in(Pose(*self._room.start))
        if self._room.clearance(true.x, true.y) < _NEAREST:
            self.doubt = "it would lead through a wall: the recording is of another room, or began elsewhere in it"
            return None
        return true


class RecordedDrive:
    """Give it all samples in the order in which they were heard."""

    def __init__(self, policy: LocalizationPolicy, place: Pose | None, room: Room | None) -> None:
        """`place`: where the robot is when odometry is first heard; None: anywhere. `room`: as of `TrueWay`."""
        self.policy = policy
        self.way = 0.0
        """m, by odometry."""
        self.seconds = 0.0
        """From the first sample to the last."""
        self.refused = ""
        """Why the robot cannot have been where it was said to be."""
        self.shares = WayByState()
        self.errors = LocalizationErrors()
        self.truth = TrueWay(room)
        self.has_truth = False
        self._place = place
        self._first_ns: int | None = None
        self._path: float | None = None
        self._segment = ("", 0)
        self._next_ns: int | None = None
        self._work()  # the map is read

    @property
    def heard_odometry(self) -> bool:
        return self._path is not None

    def on_sample(self, sample: Sample, at_ns: int) -> None:
        """`at_ns`: when it was heard, ns of any one clock."""
        self._first_ns = at_ns if self._first_ns is None else self._first_ns
        self.seconds = max(self.seconds, (at_ns - self._first_ns) * 1e-9)
        match sample:
            case Odometry():
                self._on_odometry(sample)
            case Range():
                self.policy.on_range(sample)
            case TruePose():
                self.has_truth = True
                if (true := self.truth.on_map(sample)) is not None:
                    self.errors.see(sample.tick.robot_ns, true)
            case _:
                return
        self._work()
        if self.heard_odometry and (self._next_ns is None or at_ns >= self._next_ns):
            self._next_ns = at_ns + _POSE_EVERY_NS
            self._take_pose()

    def _on_odometry(self, odometry: Odometry) -> None:
        self.truth.on_odometry(odometry)
        self.policy.on_odometry(odometry)
        if odometry.segment == self._segment and self._path is not None:
            self.way += max(0.0, odometry.path - self._path)
        self._path, self._segment = odometry.path, odometry.segment
        if self._place is not None:
            answer = self.policy.on_set_pose(told_pose(self._place))
            self.refused = "" if answer.done else str(answer.reason)
            self._place = None

    def _work(self) -> None:
        while self.policy.work():
            pass

    def _take_pose(self) -> None:
        pose = self.policy.pose()
        self.shares.come(self.way, pose.state)
        self.errors.on_pose(pose)
