"""One search for the robot by its laser scanner: places that explain what it sees, carried along until one is left.

No probability chooses between places, since the plan's small errors would: a place falls only when it explains less of
the points than the best one, over some way.
"""

import math
from collections.abc import Generator, Iterator
from typing import Any, Final, NamedTuple

import numpy as np

from giraff_core.kinematics.pose import Pose
from giraff_core.robot import RobotConfig
from giraff_core.senses import LaserScanner
from giraff_localization.clusters import upper
from giraff_localization.free_space import Floats as Floats32
from giraff_localization.free_space import FreeSpace
from giraff_localization.given_pose import GivenPose
from giraff_localization.judgement import CHECKS, DOUBTS, LOOKS, TOLD_HOLDS, UNCONFIRMED, UNHEARD, UNJUDGED, several_fit
from giraff_localization.track import Track
from giraff_maps.scan.match import Cloud, Floats, match
from giraff_maps.scan.plan_walls import PlanWalls
from giraff_maps.scan.search import are_apart
from giraff_maps.scan.turns import Turns
from giraff_schemas.localization import Candidate, LocalizationState
from giraff_schemas.messages import Range, RobotTime
from giraff_schemas.scan import LaserScan
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_STEP, _TURN = 0.1, math.radians(10.0)  # m or rad to the next update: a robot that stands learns nothing
_STEP_AT_REST, _STILL = 0.02, 0.003  # m or rad to the one update after it has stopped; within these it stands
_RESTED_NS: Final = 200_000_000  # before the end of a turn, since when it stands
_TURNING: Final = 0.1  # m of way that a radian counts for
_GRID: Final = 4  # cells from one place that is scored to the next: 0.2 m
_HEADINGS: Final = 120  # all round
_MOST: Final = 40  # places that are matched
_SPREAD: Final = 0.3, 0.3, 0.1  # m, m, rad by which a scored place may be off
_SDS: Final = 3.0  # standard deviations within which a place is that was told
_WITHIN: Final = 0.01  # m and rad by which odometry is off after no way
_DRIFT, _DRIFT_YAW = 0.1, 0.08  # and for each m and rad
_LEAP: Final = 0.5  # m between two updates: where odometry leapt, that was no motion
_MISSED: Final = 0.3  # m or rad that odometry has missed, after which all places are looked at
_SAME: Final = 0.2  # m and rad between two places that are one
_LEAST: Final = np.diag([0.01, 0.01, math.radians(0.3)]) ** 2  # covariance that is always added

_MEMORY, _RECENT = 1.0, 0.3  # m over which a place is judged, and is found to be wrong
_WORSE, _WORSE_YOUNG, _YOUNG = 0.10, 0.20, 2.0  # share less than the best at which a place falls; m while it is young
_GOOD, _HELD = 0.82, 1.0  # share that the last place explains when it is known, and m for which it does
_KEPT, _DOUBTED = 0.72, 0.10  # share below which it is known no more; share less than before at which others are tried
_FITS: Final = 0.5  # share below which a place explains nothing
_BADLY, _BADLY_LONG = 2.0, 10.0  # m after which the plan is doubted: where nothing fits, and where nothing fits well
_NARROW, _WIDE = 0.35, 0.6  # m: standard deviation up to which a place is known, and stays known
_AGAIN, _CONFIRMS = 3.0, 0.5  # m after which all places are looked at again: none is known, or one is left

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
    candidates: tuple[Candidate, ...]
    way: float


class _Place:
    """A place where the robot may be."""

    def __init__(self, pose: Floats, spread: tuple[float, float, float]) -> None:
        self.pose = pose
        self.covariance: Any = np.diag(np.square(spread))
        self.share = self.fit = self.recent = self.age = 0.0
        """Share of the points that it explains: in the newest turn, over the last metre, just now; m of way with it."""

    @property
    def spread(self) -> float:
        """m, standard deviation along the direction in which it is known least."""
        return math.sqrt(float(np.linalg.eigvalsh(self.covariance[:2, :2])[1]))

    @property
    def is_doubted(self) -> bool:
        """It explains less just now than before: the robot may have been carried away."""
        return self.recent < self.fit - _DOUBTED

    def carry(self, moved: Pose, missed: tuple[float, float]) -> None:
        """Go as odometry says. `missed`: m and rad that it may be off beside its usual errors."""
        before, self.pose = self.pose, np.array(moved.placed_in(Pose(*self.pose.tolist())))
        x, y, _ = self.pose - before
        slope = np.array([[1.0, 0.0, -y], [0.0, 1.0, x], [0.0, 0.0, 1.0]])
        drift = math.hypot(_WITHIN + _DRIFT * math.hypot(moved.x, moved.y), missed[0])
        drift_yaw = math.hypot(_WITHIN + _DRIFT_YAW * abs(moved.yaw), missed[1])
        self.covariance = slope @ self.covariance @ slope.T + np.diag([drift, drift, drift_yaw]) ** 2

    def match(self, walls: PlanWalls, cloud: Cloud) -> None:
        """Go where the turn fits. No matrix here is singular, since the covariance never is."""
        found = match(walls, cloud, self.pose, np.sqrt(np.diag(self.covariance)).tolist())
        self.pose = found.pose
        self.covariance = np.linalg.inv(found.information + np.linalg.inv(self.covariance))
        self.share = walls.explained(cloud.placed(self.pose).points)

    def judge(self, effort: float) -> None:
        """Take what it explains of the newest turn."""
        self.fit += (self.share - self.fit) * (1.0 - math.exp(-effort / _MEMORY))
        self.recent += (self.share - self.recent) * (1.0 - math.exp(-effort / _RECENT))
        self.age += effort


class ScanSearch:
    """Begins anywhere, or where it is told."""

    def __init__(
        self, space: FreeSpace, walls: PlanWalls, robot: RobotConfig, track: Track, told: GivenPose | None
    ) -> None:
        self._sensor, scanner = next(iter(robot.of(LaserScanner).items()))
        self._walls, self._told, self._turns = walls, told, Turns(scanner)
        self._newest: tuple[Cloud, bool, RobotTime] | None = None
        """Turn that waits to be looked at, whether odometry leapt before it, and the moment of its end."""
        self._free = space.places(_GRID)
        self._places: list[_Place] = []
        self._missed = 0.0, 0.0
        self._held = self._way = self._since_look = 0.0
        self._is_told = self._is_confirmed = told is not None and not told.is_wide
        self._told_left = TOLD_HOLDS if self._is_told else 0.0
        self._was_known = self._is_blind = self._is_refuted = False
        self._state: LocalizationState = "told" if self._is_told else "lost"
        track.pop_stride()
        self.updated_at = track.pose
        (x, y), sds = self._free.mean(axis=0).tolist(), [*self._free.std(axis=0), math.tau / math.sqrt(12.0)]
        self.pose, self.covariance = Pose(x, y, 0.0), upper(np.diag(sds) ** 2)
        if told is not None:
            self.pose = told.pose
            self.covariance = upper(np.diag([told.position_sd, told.position_sd, told.yaw_sd]) ** 2)
        self.judgement = self._judged()

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
            at = track.at(end)
            moved = Pose(0.0, 0.0, 0.0) if at is None else at.seen_from(self.updated_at)
            far = math.hypot(moved.x, moved.y)
            if at is None:
                self._newest = None
            elif not self._places or _is_due(moved, track, end):
                if self._places and leapt and far > _LEAP:
                    self._lose()
                missed_here, self._newest, self._missed = self._missed, None, (0.0, 0.0)
                self._way += track.pop_stride().way
                return self._update(cloud, at, moved, missed_here)
        if track.way > UNHEARD and not self._is_blind:
            self._is_blind = True
            return self._lose()
        return None

    def _lose(self) -> Iterator[None]:
        """Forget all places: the next turn is looked for anywhere."""
        self._was_known |= self._state == "localized"
        self._state, self._places, self._told, self._is_confirmed = "lost", [], None, False
        self._held = self._way = 0.0
        self._newest, self._is_refuted = None, False
        self.judgement = self._judged()
        return iter(())

    def _update(self, cloud: Cloud, at: Pose, moved: Pose, missed: tuple[float, float]) -> Iterator[None]:
        effort = math.hypot(moved.x, moved.y) + _TURNING * abs(moved.yaw)
        self._is_blind = False
        self._since_look += effort
        for place in self._places:
            place.carry(moved, missed)
            place.match(self._walls, cloud)
            place.judge(effort)
            yield
        if not self._places or self._since_look >= self._looks_after(self._places[0]):
            confirms = self._held >= _CONFIRMS
            yield from self._find(cloud, moved, missed)
            self._is_confirmed |= confirms
        self._places.sort(key=lambda place: -place.fit)
        best, kept = self._places[0], list[_Place]()
        for place in self._places:
            worse = _WORSE if place.age >= _YOUNG else _WORSE_YOUNG
            if place.fit > best.fit - worse and all(are_apart(place.pose, each.pose, _SAME, _SAME) for each in kept):
                kept.append(place)
        self._places = kept
        self.updated_at, self.pose = at, Pose(*best.pose.tolist())
        self.covariance = upper(best.covariance + _LEAST)
        self._judge(best, effort)

    def _looks_after(self, best: _Place) -> float:
        """Return m since the last time after which all places are looked at: another one may explain more."""
        if self._state == "localized":
            return _RECENT if best.is_doubted else math.inf
        if self._state == "told":
            return UNJUDGED
        if self._held >= _CONFIRMS and not self._is_confirmed:
            return 0.0
        return _AGAIN if len(self._places) < _MOST else math.inf

    def _find(self, cloud: Cloud, moved: Pose, missed: tuple[float, float]) -> Generator[None, None, None]:
        """Look for the turn anywhere, or about the place that was told: add the places that explain it."""
        free, headings, told, starts = (
            self._free,
            np.linspace(0.0, math.tau, _HEADINGS, False),
            self._told,
            list[_Place](),
        )
        if told is not None:
            sd, yaw_sd = told.position_sd, told.yaw_sd
            starts.append(_Place(np.array(told.pose), (sd + _WITHIN, sd + _WITHIN, yaw_sd + _WITHIN)))
            starts[0].carry(moved, missed)
            free = free[np.hypot(*(free - starts[0].pose[:2]).T) <= _SDS * sd]
            turned = np.abs((headings - starts[0].pose[2] + math.pi) % math.tau - math.pi)
            headings = headings[turned <= _SDS * yaw_sd]
        poses = yield from self._walls.best(cloud.points, free, headings, _MOST)
        starts += [_Place(pose, _SPREAD) for pose in poses]
        for place in starts:
            place.match(self._walls, cloud)
            yield
        starts.sort(key=lambda place: -place.share)
        if told is not None and not told.is_wide:
            del starts[1:]
        best, worse = self._places[0] if self._places else starts[0], _WORSE
        if not self._places:
            best.fit, worse = best.share, _WORSE_YOUNG
        elif self._state in ("localized", "told"):
            worse = -_WORSE  # what explains as much is no reason to doubt
        found = [place for place in starts if place.share > best.share - worse]
        fit = best.fit
        for place in found:
            place.fit = place.recent = fit + place.share - best.share
            place.age = best.age
        self._places += found
        self._is_refuted = worse < 0.0 and bool(found)
        self._told, self._since_look = None, 0.0

    def _judge(self, best: _Place, effort: float) -> None:
        is_one, is_good = len(self._places) == 1, best.fit >= _GOOD and not best.is_doubted
        self._held = self._held + effort if is_one and is_good and best.spread <= _NARROW else 0.0
        self._told_left -= effort
        if self._state in ("localized", "told") and self._is_refuted:
            self._lose()
        elif self._state == "localized":
            if best.recent < _KEPT or best.spread > _WIDE:
                self._lose()
        elif self._held >= _HELD and self._is_confirmed:
            self._state, self._is_told = "localized", False
        elif self._state == "told":
            if self._told_left <= 0.0 or (best.recent < _FITS and self._told_left < TOLD_HOLDS - UNJUDGED):
                self._lose()
        else:
            self._state = "ambiguous" if not is_one and best.fit >= _FITS else "lost"
        self._way = 0.0 if self._state == "localized" else self._way
        self.judgement = self._judged()

    def _judged(self) -> ScanJudgement:
        if self._state == "localized":
            return ScanJudgement("localized", NO_TROUBLE, (), 0.0)
        likely = np.exp([(place.fit - self.explained) / _WORSE for place in self._places])
        poses, beliefs = self.sample(len(likely)).T.tolist(), (likely / likely.sum()).tolist()
        candidates = (
            Candidate(x=x, y=y, yaw=math.remainder(yaw, math.tau), belief=belief)
            for (x, y, yaw), belief in zip(poses, beliefs, strict=True)
        )
        return ScanJudgement(self._state, self._reason, tuple(candidates), self._way)

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


def _is_due(moved: Pose, track: Track, end: RobotTime) -> bool:
    """Tell whether the turn that ended then is looked at. `moved`: since the last one that was."""
    far, angle = math.hypot(moved.x, moved.y), abs(moved.yaw)
    before = track.at(RobotTime(epoch=end.epoch, robot_ns=end.robot_ns - _RESTED_NS))
    since = None if before is None else track.pose.seen_from(before)
    if since is not None and max(map(abs, since)) < _STILL:
        return max(far, angle) >= _STEP_AT_REST
    return far >= _STEP or angle >= _TURN
