"""One search for the robot, whatever it is found by."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple, Protocol

from giraff_core.kinematics.calibration import Covariance
from giraff_core.kinematics.pose import Pose
from giraff_localization.free_space import Floats
from giraff_localization.track import Track
from giraff_schemas.localization import Candidate, LocalizationState
from giraff_schemas.messages import Range
from giraff_schemas.scan import LaserScan
from giraff_schemas.trouble import Trouble

_WIDE = 0.5
"""m or rad, of a pose that somebody told: one that is less sure takes more particles."""


class GivenPose(NamedTuple):
    """A pose that somebody has told."""

    pose: Pose
    position_sd: float
    yaw_sd: float

    @property
    def is_wide(self) -> bool:
        """Who is so unsure has told a part of the map, and no place."""
        return max(self.position_sd, self.yaw_sd) > _WIDE


class Judged(Protocol):
    """Whether it is known where the robot is."""

    @property
    def state(self) -> LocalizationState: ...
    @property
    def reason(self) -> Trouble:
        """Cause, while it is not known."""

    @property
    def candidates(self) -> Sequence[Candidate]:
        """While it is not known, best first."""

    @property
    def way(self) -> float:
        """m since it was last known where it is, or since the search began."""


class Search(Protocol):
    """Begins anywhere, or where somebody says that the robot is."""

    @property
    def pose(self) -> Pose:
        """Best guess, in `map`: where the robot was when it was at `updated_at`."""

    @property
    def covariance(self) -> Covariance:
        """Of `pose`."""

    @property
    def updated_at(self) -> Pose:
        """Pose of the newest update in the frame of the track."""

    @property
    def judgement(self) -> Judged: ...
    @property
    def explained(self) -> float:
        """Share of the last metres' readings, 0..1, that the best place explains."""

    @property
    def count(self) -> int:
        """Particles, or places that are followed."""

    def sample(self, count: int) -> Floats:
        """Return x, y, yaw of so many of them at most; shape (3, n)."""

    def on_sample(self, sample: Range | LaserScan) -> None:
        """Take what a sensor has heard."""

    def update(self, track: Track) -> Iterator[None] | None:
        """Begin an update by all that has come since the last one, in parts; None: none is due."""
