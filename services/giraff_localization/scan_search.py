"""One search for the robot by its laser scanner: places that explain what it sees, carried along until one is left.

No probability chooses between places, since the plan's small errors would: a place falls only when it explains less of
the points than the best one, over some way.
"""

import math
from collections.abc import Generator, Iterator
from typing import Final, NamedTuple

import numpy as np

from giraff_core.kinematics.calibration import Covariance
from giraff_core.kinematics.pose import Pose
from giraff_core.robot import RobotConfig
from giraff_core.senses import LaserScanner
from giraff_localization.free_space import Floats as Floats32
from giraff_localization.free_space import FreeSpace
from giraff_localization.judgement import (
    CHECKS,
    DOUBTS,
    LOOKS,
    TOLD_HOLDS,
    UNCONFIRMED,
    UNHEARD,
    UNJUDGED,
    several_fit,
)
from giraff_localization.search import GivenPose
from giraff_localization.track import Track
from giraff_maps.scan.match import Cloud, Floats, match
from giraff_maps.scan.plan_walls import PlanWalls
from giraff_maps.scan.search import are_apart
from giraff_maps.scan.turns import Turns
from giraff_schemas.localization import Candidate, LocalizationState
from giraff_schemas.messages import Range, RobotTime
from giraff_schemas.scan import LaserScan
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_STEP, _TURN = 0.1, math.radians(10.0)
"""m or rad from one update to the next: a robot that stands learns nothing."""
_TURNING: Final = 0.1  # m of way that a radian counts for
_GRID: Final = 4  # cells from one place that is scored to the next: 0.2 m
_HEADINGS: Final = [number * math.tau / 120 for number in range(120)]
_MOST: Final = 40  # places that are matched
_SPREAD: Final = 0.3, 0.3, 0.1  # m, m, rad by which a scored place may be off
_SDS: Final = 3.0  # within which a place lies that was told
_WITHIN, _WITHIN_YAW = 0.01, 0.01  # m, rad after no way, of odometry
_DRIFT, _DRIFT_YAW = 0.1, 0.08  # and after a metre or radian more
_LEAP: Final = 0.5  # m between two updates that odometry leapt, and not the robot
_MISSED: Final = 0.3  # m or rad that odometry may have missed and the robot is still found there
_SAME, _SAME_YAW = 0.2, 0.2  # m, rad between two places that are one

_MEMORY, _RECENT = 1.0, 0.3  # m over which a place is judged, and found to be wrong
_WORSE, _WORSE_YOUNG, _YOUNG = 0.10, 0.20, 2.0  # share of the points less than the best, at which it falls; m
_GOOD, _HELD = 0.70, 1.0  # share that the one place explains to be known, and m on which it does
_KEPT: Final = 0.60  # share below which it is known no more
_DOUBTED: Final = 0.10  # share less than over the last metre, at which other places are looked at
_FITS: Final = 0.5  # share below which a place explains nothing
_BADLY, _BADLY_LONG = 2.0, 10.0  # m after which the plan is doubted: where nothing fits, where nothing fits well
_NARROW, _WIDE = 0.35, 0.6  # m: standard deviation up to which a place is known, and stays known
_AGAIN: Final = 3.0  # m after which all places are looked at again while none is known
_CONFIRMS: Final = 0.5  # m after which they are, before the one that is left is believed
_LEAST: Final = np.diag([0.01, 0.01, math.radians(0.3)]) ** 2

_FITS_BADLY: Final = Trouble(
    "the scan fits this plan badly: it is of another place, or much has moved",
    "check the plan; `giraff map make --onto NAME` redraws it",
)
_SEES_NOTHING: Final = Trouble(
    "the laser scanner has told nothing for some metres", "check that giraff_scan runs, and what it says of the scanner"
)


class ScanJudgement(NamedTuple):
    """Judgement of one search."""

    state: LocalizationState
    reason: Trouble
    candidates: tuple[Candidate, ...] = ()
    way: float = 0.0


class _Place:
    """A place where the robot may be."""

    def __init__(self, pose: Floats, spread: tuple[float, float, float]) -> None:
        self.pose, self.covariance = pose, np.diag(np.square(spread))
        self.share = self.fit = self.recent = self.age = 0.0
        """Share of the points that it explains in the newest turn, over the last metre and just now; m that it has been
        followed."""

    @property
    def spread(self) -> float:
        """m, standard deviation along the direction in which it is known least."""
        return math.sqrt(float(np.linalg.eigvalsh(self.covariance[:2, :2])[1]))

    def carry(self, moved: Pose, missed: tuple[float, float]) -> None:
        """Go as odometry says. `missed`: m and rad that it may be off beside its usual errors."""
        before = self.pose
        self.pose = np.array(moved.placed_in(Pose(*before.tolist())))
        x, y, _ = self.pose - before
        slope = np.array([[1.0, 0.0, -y], [0.0, 1.0, x], [0.0, 0.0, 1.0]])
        drift = _WITHIN + _DRIFT * math.hypot(moved.x, moved.y)
        drift_yaw = _WITHIN_YAW + _DRIFT_YAW * abs(moved.yaw)
        variances = drift**2 + missed[0] ** 2, drift**2 + missed[0] ** 2, drift_yaw**2 + missed[1] ** 2
        self.covariance = slope @ self.covariance @ slope.T + np.diag(variances)

    def match(self, walls: PlanWalls, cloud: Cloud) -> None:
        """Take what a turn saw. No matrix here is singular: the covariance never is."""
        found = match(walls, cloud, self.pose, np.sqrt(np.diag(self.covariance)).tolist())
        self.pose = found.pose
        self.covariance = np.linalg.inv(found.information + np.linalg.inv(self.covariance))
        self.share = walls.explained(cloud.placed(self.pose).points)

    def age_by(self, effort: float) -> None:
        """Count the newest turn."""
        self.fit += (self.share - self.fit) * (1.0 - math.exp(-effort / _MEMORY))
        self.recent += (self.share - self.recent) * (1.0 - math.exp(-effort / _RECENT))
        self.age += effort


class ScanSearch:
    """Begins anywhere, or where it is told."""

    def __init__(
        self, space: FreeSpace, walls: PlanWalls, robot: RobotConfig, track: Track, told: GivenPose | None
    ) -> None:
        self._walls, self._told = walls, told
        (self._sensor, scanner), *_ = robot.of(LaserScanner).items()
        self._turns = Turns(scanner)
        self._newest: tuple[Cloud, bool, RobotTime] | None = None
        """Turn that waits to be looked at, whether odometry leapt before it, and the moment of its end."""
        self._free = space.places(_GRID)
        self._places: list[_Place] = []
        self._missed = 0.0, 0.0
        self._held = self._way = self._since_look = 0.0
        self._told_left = TOLD_HOLDS if told is not None and not told.is_wide else 0.0
        self._is_told = self._is_confirmed = self._told_left > 0.0
        self._was_known = self._is_blind = False
        self._state: LocalizationState = "told" if self._is_told else "lost"
        track.pop_stride()
        self.updated_at = track.pose
        self.pose, self._covariance = self._begun(told)
        self.judgement = self._judged()

    @property
    def covariance(self) -> Covariance:
        xx, xy, xt, _, yy, yt, _, _, tt = self._covariance.ravel().tolist()
        return xx, xy, xt, yy, yt, tt

    @property
    def explained(self) -> float:
        """Share of the points of the last metre, 0..1, that lie on walls at the best place."""
        return self._places[0].fit if self._places else 0.0

    @property
    def count(self) -> int:
        return len(self._places)

    def sample(self, count: int) -> Floats32:
        """Return x, y, yaw of the places that are followed; shape (3, n)."""
        return np.array([place.pose for place in self._places[:count]], np.float32).reshape(-1, 3).T

    def on_sample(self, sample: Range | LaserScan) -> None:
        """Take a turn of the scanner: the one before it is complete then."""
        if isinstance(sample, LaserScan) and sample.sensor == self._sensor:
            turn, tick = self._turns.add(sample), sample.tick
            if turn is not None and tick is not None:
                end = RobotTime(epoch=tick.epoch, robot_ns=tick.robot_ns + round(sample.since_tick * 1e9))
                self._newest = turn.cloud, turn.leapt or (self._newest is not None and self._newest[1]), end

    def update(self, track: Track) -> Iterator[None] | None:
        """Begin an update by the newest turn, in parts; None: none is due."""
        if track.has_missed:
            missed, missed_yaw = track.pop_stride().missed
            self._missed = math.hypot(self._missed[0], missed), math.hypot(self._missed[1], missed_yaw)
            self._newest = None
            if self._places and max(self._missed) > _MISSED:
                return self._lose()
        if self._newest is not None and not track.is_ahead(self._newest[2]):
            cloud, leapt, end = self._newest
            if (at := track.at(end)) is None:
                self._newest = None
            else:
                moved = at.seen_from(self.updated_at)
                far = math.hypot(moved.x, moved.y)
                if far >= _STEP or abs(moved.yaw) >= _TURN or not self._places:
                    if self._places and leapt and far > _LEAP:
                        self._lose()
                    self._newest, missed_here, self._missed = None, self._missed, (0.0, 0.0)
                    self._way += track.way
                    track.pop_stride()
                    return self._update(cloud, at, moved, missed_here)
        if track.way > UNHEARD and not self._is_blind:
            self._is_blind = True
            return self._lose()
        return None

    def _lose(self) -> Iterator[None]:
        """Forget all places: the next turn is looked for anywhere."""
        self._was_known |= self._state == "localized"
        self._state, self._places, self._told, self._is_confirmed = "lost", [], None, False
        self._held = self._way = self._told_left = 0.0
        self.judgement = self._judged()
        return iter(())

    def _update(self, cloud: Cloud, at: Pose, moved: Pose, missed: tuple[float, float]) -> Iterator[None]:
        effort = math.hypot(moved.x, moved.y) + _TURNING * abs(moved.yaw)
        self._is_blind = False
        self._since_look += effort
        for place in self._places:
            place.carry(moved, missed)
            place.match(self._walls, cloud)
            place.age_by(effort)
            yield
        if not self._places or self._looks_again():
            confirms = self._held >= _CONFIRMS
            yield from self._find(cloud, moved, missed)
            self._is_confirmed |= confirms
        self._drop()
        best = self._places[0]
        self.updated_at, self.pose = at, Pose(*best.pose.tolist())
        self._covariance = best.covariance + _LEAST
        self._judge(best, effort)

    def _looks_again(self) -> bool:
        """Return whether all places are looked at: another one may explain more."""
        best = self._places[0]
        if self._state == "localized":
            return best.recent < best.fit - _DOUBTED and self._since_look >= _MEMORY
        if self._state == "told":
            return False
        return self._since_look >= _AGAIN or (self._held >= _CONFIRMS and not self._is_confirmed)

    def _find(self, cloud: Cloud, moved: Pose, missed: tuple[float, float]) -> Generator[None, None, None]:
        """Look for the turn anywhere, or about the place that was told: add the places that explain it."""
        free, headings, starts, told = self._free, np.array(_HEADINGS), list[_Place](), self._told
        if told is not None:
            pose, sd, yaw_sd = told
            place = _Place(np.array(pose), (sd + _WITHIN, sd + _WITHIN, yaw_sd + _WITHIN_YAW))
            place.carry(moved, missed)
            starts.append(place)
            x, y, yaw = place.pose
            free = free[np.hypot(*(free - (x, y)).T) <= _SDS * sd]
            turned = np.abs((headings - yaw + math.pi) % math.tau - math.pi)
            headings = headings[turned <= _SDS * yaw_sd]
        if free.size and headings.size:
            poses = yield from self._walls.best(cloud.points, free, headings, _MOST)
            starts += [_Place(pose, _SPREAD) for pose in poses]
        for place in starts:
            place.match(self._walls, cloud)
            yield
        starts.sort(key=lambda place: -place.share)
        margin = _WORSE if self._places else _WORSE_YOUNG
        if self._state == "localized":
            margin = -_WORSE  # what explains less or as much is no reason to doubt
        best = self._places[0] if self._places else starts[0]
        fit = best.fit if self._places else best.share
        for place in starts[:1] if told is not None and not told.is_wide else starts:
            if place.share > best.share - margin:
                place.fit = place.recent = fit + place.share - best.share
                self._places.append(place)
        self._told, self._since_look = None, 0.0

    def _drop(self) -> None:
        """Keep the places that explain about as much as the best one, best first."""
        self._places.sort(key=lambda place: -place.fit)
        kept = list[_Place]()
        for place in self._places:
            worse = _WORSE if place.age >= _YOUNG else _WORSE_YOUNG
            if place.fit > self._places[0].fit - worse and all(
                are_apart(place.pose, other.pose, _SAME, _SAME_YAW) for other in kept
            ):
                kept.append(place)
        self._places = kept

    def _judge(self, best: _Place, effort: float) -> None:
        is_one = len(self._places) == 1
        self._held = self._held + effort if is_one and best.fit >= _GOOD and best.spread <= _NARROW else 0.0
        self._told_left = max(0.0, self._told_left - effort)
        if self._state == "localized":
            if best.recent < _KEPT or best.spread > _WIDE or best.age == 0.0:
                self._lose()
                return
        elif self._held >= _HELD and self._is_confirmed:
            self._state, self._is_told = "localized", False
        elif self._state == "told":
            is_wrong = best.recent < _FITS and self._told_left < TOLD_HOLDS - UNJUDGED
            if is_wrong or not self._told_left or not is_one:
                self._lose()
                return
        else:
            self._state = "ambiguous" if not is_one and best.fit >= _FITS else "lost"
        if self._state == "localized":
            self._way = 0.0
        self.judgement = self._judged()

    def _judged(self) -> ScanJudgement:
        if self._state == "localized":
            return ScanJudgement("localized", NO_TROUBLE)
        weights = np.exp([(place.fit - self.explained) / _WORSE for place in self._places])
        candidates = tuple(
            Candidate(x=x, y=y, yaw=math.remainder(yaw, math.tau), belief=belief)
            for (x, y, yaw), belief in zip(
                (place.pose.tolist() for place in self._places), (weights / weights.sum()).tolist(), strict=True
            )
        )
        return ScanJudgement(self._state, self._reason, candidates, self._way)

    @property
    def _reason(self) -> Trouble:
        if self._is_blind:
            return _SEES_NOTHING
        if self._state == "told":
            return CHECKS
        if self._places and self._way > _BADLY and self.explained < (_FITS if self._way < _BADLY_LONG else _GOOD):
            return _FITS_BADLY
        if self._state == "ambiguous":
            return several_fit(len(self._places))
        if self._is_told:
            return UNCONFIRMED
        return DOUBTS if self._was_known else LOOKS

    def _begun(self, told: GivenPose | None) -> tuple[Pose, Floats]:
        """Return the best guess before anything was seen, and its covariance."""
        if told is not None:
            return told.pose, np.diag([told.position_sd, told.position_sd, told.yaw_sd]) ** 2
        x, y = self._free.mean(axis=0).tolist()
        covariance = np.diag([0.0, 0.0, math.tau**2 / 12.0])
        covariance[:2, :2] = np.cov(self._free.T)
        return Pose(x, y, 0.0), covariance
