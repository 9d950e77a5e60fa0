"""One search for the robot: particles, a restart cloud, equivalent places, and the judgement of whether it is known
where it is.

D. Fox, W. Burgard, F. Dellaert, S. Thrun, Monte Carlo Localization: Efficient Position Estimation for Mobile Robots,
AAAI 1999; here with the wheels' scales in each particle, and a judge of its own.
"""

import math
from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np

from giraff_core.kinematics.pose import Pose
from giraff_core.robot import RobotConfig
from giraff_core.senses import Ultrasonic
from giraff_localization.beams.readings import Readings
from giraff_localization.beams.ultrasonic import Beam
from giraff_localization.cloud import Cloud
from giraff_localization.clusters import Cluster, clusters, whole
from giraff_localization.config import LocalizationConfig
from giraff_localization.equivalent_places import EquivalentPlaces
from giraff_localization.fit import RECENT, Fit, compare
from giraff_localization.floor import Floor
from giraff_localization.free_space import Floats
from giraff_localization.given_pose import GivenPose
from giraff_localization.judgement import Fits, Judgement
from giraff_localization.restart_cloud import RestartCloud
from giraff_localization.track import Stride, Track
from giraff_schemas.messages import Range
from giraff_schemas.scan import LaserScan

_STEP: Final = 0.1
"""m from one update to the next: a robot that stands learns nothing."""
_TURN: Final = math.radians(10.0)
"""rad; the same of turns."""


class Filter:
    """Begins anywhere, or where it is told. The same seed gives the same search."""

    def __init__(
        self,
        floor: Floor,
        config: LocalizationConfig,
        robot: RobotConfig,
        seed: int,
        track: Track,
        told: GivenPose | None,
    ) -> None:
        self._floor, self._config, self._robot = floor, config, robot
        self._random = np.random.default_rng(seed)
        self._cloud = self._anywhere(config.most_particles) if told is None else self._about(told)
        self._restart_cloud = RestartCloud(self._anywhere, config.most_particles // 2)
        self._equivalent_places = EquivalentPlaces(floor)
        self._readings = Readings(robot.of(Ultrasonic), floor.sonars)
        self._fit, self._recent = Fit(), Fit(RECENT)
        self._total = 0.0
        self._best: Cluster | None = None
        """Where most particles are."""
        track.pop_stride()
        self.updated_at = track.pose
        begun = whole(self._cloud)
        self.pose, self.covariance = begun.pose, begun.covariance
        self._unheard = 0.0
        """m since any reading said anything."""
        self.judgement = Judgement(was_told=told is not None and not told.is_wide)

    @property
    def count(self) -> int:
        return self._cloud.count

    @property
    def explained(self) -> float:
        """Share of the last metres' readings, 0..1, that the best place explains."""
        return self._fit.forgiving

    def sample(self, count: int) -> Floats:
        """Return x, y, yaw of so many particles at most, drawn by their weights."""
        return self._cloud.sample(count)

    def on_sample(self, sample: Range | LaserScan) -> None:
        """Take what a sonar has heard."""
        if isinstance(sample, Range):
            self._readings.on_range(sample)

    def update(self, track: Track) -> Iterator[None] | None:
        """Begin an update, in parts; None: none is due."""
        self._readings.place(track)
        if track.way < _STEP and track.turned < _TURN and not track.has_missed:
            return None
        here, stride = track.pose, track.pop_stride()
        return self._update(here, stride, self._readings.pop_beams(here, stride.effort))

    def _update(self, here: Pose, stride: Stride, beams: Sequence[Beam]) -> Iterator[None]:
        floor, restart_cloud = self._floor, self._restart_cloud
        restart_cloud.begin(self._cloud, self._total)
        for cloud in (self._cloud, restart_cloud.cloud):
            if cloud is not None:
                cloud.move(stride)
                cloud.weigh(beams, floor.sonars)
                yield
        self._cloud.resample(self._config.least_particles, self._config.most_particles)
        self._total += stride.effort
        before = self._cloud
        self._cloud = restart_cloud.judge(before, stride.effort)
        if self._cloud is not before:
            self._fit, self._recent = Fit(), Fit(RECENT)
            self.judgement.begin_anew()
        yield
        found = clusters(self._cloud)
        self._best = found[0] if found else None
        rivals = clusters(restart_cloud.cloud) if restart_cloud.is_settled and restart_cloud.cloud is not None else []
        if self._best is not None:
            self.updated_at, self.pose, self.covariance = here, self._best.pose, self._best.covariance
            counts = compare(floor, self._best.pose, beams)
            self._fit.add(counts, stride.effort)
            self._recent.add(counts, stride.effort)
            self._unheard = 0.0 if counts.total else self._unheard + stride.effort
        known = self.judgement.state == "localized" or len(self.judgement.candidates) > 1
        fits = Fits(self._fit.forgiving, self._recent.forgiving, self._unheard)
        self.judgement.judge(found, rivals, fits, restart_cloud.lead, self._equivalent_places.poses, stride)
        self._equivalent_places.follow(
            None if self._best is None else self._best.pose,
            stride,
            beams,
            self.judgement.others,
            known=known,
        )

    def _anywhere(self, count: int) -> Cloud:
        return Cloud(self._floor.space, self._robot, self._floor.space.anywhere(count, self._random), self._random)

    def _about(self, told: GivenPose) -> Cloud:
        count = self._config.most_particles if told.is_wide else self._config.least_particles
        sds = np.array([told.position_sd, told.position_sd, told.yaw_sd])[:, None]
        poses = np.array(told.pose)[:, None] + sds * self._random.normal(0.0, 1.0, (3, count))
        return Cloud(self._floor.space, self._robot, poses.astype(np.float32), self._random)
