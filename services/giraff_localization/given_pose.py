"""A pose that somebody has told, and how sure it is."""

from typing import Final, NamedTuple

from giraff_core.kinematics.pose import Pose

_WIDE: Final = 0.5
"""m or rad, of a pose that somebody told: one that is less sure takes more particles."""


class GivenPose(NamedTuple):
    """A pose that somebody has told."""

    pose: Pose
    position_sd: float
    yaw_sd: float

    @property
    def is_wide(self) -> bool:
        """Return whether it is a part of the map rather than a place."""
        return max(self.position_sd, self.yaw_sd) > _WIDE
