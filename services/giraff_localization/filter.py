"""One search for the robot: particles, a restart cloud, equivalent places, and the judgement of whether it is known
where it is.

D. Fox, W. Burgard, F. Dellaert, S. Thrun, Monte Carlo Localization: Efficient Position Estimation for Mobile Robots,
AAAI 1999; here with the wheels' scales in each particle, and a judge of its own.
"""

from collections.abc import Iterator, Sequence
from typing import Final, NamedTuple

import numpy as np

from giraff_core.kinematics.pose import Pose
from giraff_core.robot import RobotConfig
from giraff_localization.cloud import Beam, Cloud
from giraff_localization.clusters import Cluster, clusters, whole
from giraff_localization.config import LocalizationConfig
from giraff_localization.equivalent_places import EquivalentPlaces
from giraff_localization.fit import RECENT, Fit, compare
from giraff_localization.floor import Floor
from giraff_localization.judgement import Fits, Judgement
from giraff_localization.restart_cloud import RestartCloud
from giraff_localization.track import Stride

_WIDE: Final = 0.5
"""m or rad, of a pose that somebody told: one that is less sure takes more particles."""


class GivenPose(NamedTuple):
    """Where somebody says that the robot is."""

    pose: Pose
    position_sd: float
    yaw_sd: float

    @property
    def is_wide(self) -> bool:
        """Who is so unsure has told a part of the map, and no place."""
        return max(self.position_sd, self.yaw_sd) > _WIDE


class Filter:
    """Begins anywhere, or where it is told. The same seed gives the same search."""

    def __init__(
        self, floor: Floor, config: LocalizationConfig, robot: RobotConfig, seed: int, told: GivenPose | None = None
    ) -> None:
        self._floor, self._config, self._robot = floor, config, robot
        self._random = np.random.default_rng(seed)
        self._cloud = self._anywhere(config.most_particles) if told is None else self._about(told)
        self._restart_cloud = RestartCloud(self._anywhere, config.most_particles // 2)
        self._equivalent_places = EquivalentPlaces(floor)
        self._fit, self._recent = Fit(), Fit(RECENT)
        self._total = 0.0
        self.best: Cluster | None = None
        """Where most particles are."""
        self._unheard = 0.0
        """m since any reading said anything."""
        self.judgement = Judgement(was_told=told is not None and not told.is_wide)

    @property
    def begun(self) -> Cluster:
        """All particles as they are: the best guess before anything was heard."""
        return whole(self._cloud)

    @property
    def cloud(self) -> Cloud:
        return self._cloud

    @property
    def explained(self) -> float:
        """Share of the last metres' readings, 0..1, that the best place explains."""
        return self._fit.forgiving

    def update(self, stride: Stride, beams: Sequence[Beam]) -> Iterator[None]:
        """Take one stride and what was heard on it, in parts."""
        floor, restart_cloud = self._floor, self._restart_cloud
        restart_cloud.begin(self._cloud, self._total)
        for cloud in (self._cloud, restart_cloud.cloud):
            if cloud is not None:
                cloud.move(stride)
                cloud.weigh(beams, floor.table, floor.model)
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
        self.best = found[0] if found else None
        rivals = clusters(restart_cloud.cloud) if restart_cloud.is_settled and restart_cloud.cloud is not None else []
        if self.best is not None:
            counts = compare(floor, self.best.pose, beams)
            self._fit.add(counts, stride.effort)
            self._recent.add(counts, stride.effort)
            self._unheard = 0.0 if counts.total else self._unheard + stride.effort
        known = self.judgement.state == "localized" or len(self.judgement.candidates) > 1
        fits = Fits(self._fit.forgiving, self._recent.forgiving, self._unheard)
        self.judgement.judge(found, rivals, fits, restart_cloud.lead, self._equivalent_places.poses, stride)
        self._equivalent_places.follow(
            None if self.best is None else self.best.pose,
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
