"""How far what localization says is from the truth on the map. SI units."""

import math
from array import array
from collections import deque
from typing import Final, NamedTuple

from giraff_core.kinematics.pose import Pose
from giraff_schemas.localization import LocalizationState, MapPose

_KEPT: Final = 100  # poses: ten seconds, more than lie between two looks at the truth


class LocalizationError(NamedTuple):
    """At one moment."""

    state: LocalizationState
    """What it said of itself."""
    distance: float
    """m."""
    angle: float
    """rad, never negative."""


class Spread(NamedTuple):
    """Of many errors."""

    median: float
    p95: float
    """95 % of them are no larger."""
    worst: float


class LocalizationErrors:
    """Each pose against the truth at its own moment.

    The two are not known at the same moments: the truth, which never jumps, is interpolated to the moment of each pose,
    as soon as it is known on both sides of it.
    """

    def __init__(self) -> None:
        self.newest: LocalizationError | None = None
        """At the newest pose that the truth reaches up to; None: at none so far."""
        self._poses: deque[MapPose] = deque(maxlen=_KEPT)
        self._before: tuple[int, Pose] | None = None
        self._distances, self._angles = array("d"), array("d")

    def on_pose(self, pose: MapPose) -> None:
        """Each in turn."""
        self._poses.append(pose)

    def see(self, robot_ns: int, truth: Pose) -> None:
        """Where `base_link` truly is in `map` at a moment of the robot's clock, each later than the one before."""
        before, self._before = self._before, (robot_ns, truth)
        while self._poses:
            pose = self._poses[0]
            if pose.tick is not None and pose.tick.robot_ns > robot_ns:
                return
            self._poses.popleft()
            if before is not None and pose.tick is not None and before[0] <= pose.tick.robot_ns:
                passed, took = pose.tick.robot_ns - before[0], robot_ns - before[0]
                self._compare(pose, before[1].towards(truth, passed / took if took else 1.0))

    @property
    def distances(self) -> Spread | None:
        """m, of what it said while it was `localized`; None: it never was."""
        return _spread(self._distances)

    @property
    def angles(self) -> Spread | None:
        """rad; the same."""
        return _spread(self._angles)

    def _compare(self, pose: MapPose, truth: Pose) -> None:
        if pose.state == "no_map":
            return
        angle = abs(math.remainder(pose.yaw - truth.yaw, math.tau))
        self.newest = LocalizationError(pose.state, math.hypot(pose.x - truth.x, pose.y - truth.y), angle)
        if pose.state == "localized":
            self._distances.append(self.newest.distance)
            self._angles.append(angle)


def _spread(errors: "array[float]") -> Spread | None:
    if not errors:
        return None
    ordered = sorted(errors)
    last = len(ordered) - 1
    return Spread(ordered[round(0.5 * last)], ordered[math.ceil(0.95 * last)], ordered[-1])
