"""The newest pose on the map, and why nobody may drive by it. No I/O and no clock."""

import math
from typing import Final

from giraff_schemas.localization import MapPose
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_HEARD: Final = 1.0
"""s; localization tells the pose ten times a second."""

_NEVER: Final = Trouble("no pose on the map is heard", "start giraff_localization")
_SILENT: Final = Trouble("no pose on the map is heard any more", "check giraff_localization")
_TWO: Final = Trouble(
    "two processes say where the robot is on the map", "see both with `giraff node list`, and stop one of them"
)


class HeardMapPose:
    """Times are s of any one monotonic clock."""

    def __init__(self) -> None:
        self.pose: MapPose | None = None
        """The newest; None: none was heard."""
        self.heard = -math.inf
        """Moment when it came."""
        self._disputed = -math.inf
        """Moment when two processes last told the pose beside each other."""

    def on_pose(self, pose: MapPose, now: float) -> None:
        """Take where the robot is on the map."""
        if self.pose is not None and pose.instance != self.pose.instance and now - self.heard <= _HEARD:
            self._disputed = now
        self.pose, self.heard = pose, now

    def dispute(self, now: float) -> Trouble:
        """Return that two processes tell the pose; NO_TROUBLE: one does, or none."""
        return _TWO if now - self._disputed <= _HEARD else NO_TROUBLE

    def fault(self, now: float) -> Trouble:
        """Return why nobody may go by it."""
        if (pose := self.pose) is None:
            return _NEVER
        if now - self.heard > _HEARD:
            return _SILENT
        if dispute := self.dispute(now):
            return dispute
        if pose.state not in {"localized", "told"}:
            unknown = f"it is not known where the robot is on the map ({pose.state})"
            return pose.reason or Trouble(unknown, "", "run", "giraff localize")
        return NO_TROUBLE
