"""Places that were candidates once, and explain what is heard as well as the best one does.

Particles forget them: of two rooms that are equal, one has none left after some metres. So each is carried along with
the best one, and is dropped only when it explains less. It has a few particles of its own. A place that is only carried
on by odometry drifts off and then explains less for that reason alone.
"""

import math
from collections.abc import Iterable, Sequence
from typing import Final

import numpy as np

from giraff_core.kinematics.pose import Pose
from giraff_localization.beams.ultrasonic import Beam
from giraff_localization.cloud import OUTSIDE, Weights
from giraff_localization.clusters import are_near
from giraff_localization.fit import Fit, compare
from giraff_localization.floor import Floor
from giraff_localization.free_space import Floats
from giraff_localization.track import Stride

_WORSE: Final = 0.08
"""Share of the readings. A place that explains so much less than the best is not equivalent."""
_YOUNG: Final = 1.0
"""m of way, turns counted, on which a new one settles. It counts as the best one does until then."""
_MOST: Final = 8
_LEAP: Final = 0.5
"""m or rad beside odometry. The best place is another one after such a step."""
_PARTICLES: Final = 64
_BEGINS: Final = np.array([0.15, 0.15, 0.1])[:, None]
_WANDERS: Final = np.array([0.04, 0.04, 0.03])[:, None, None]
"""m, m and rad, standard deviations of an equivalent place's particles: as it begins, and added in each metre."""
_EFFECTIVE: Final = 0.5
"""Share of the particles that may count for nothing before they are drawn anew."""


class _Place:
    """One place."""

    def __init__(self, pose: Pose, fit: Fit, random: "np.random.Generator") -> None:
        spread = _BEGINS * random.standard_normal((3, _PARTICLES))
        self.poses: Floats = (np.array(pose)[:, None] + spread).astype(np.float32)
        self.log_weights: Weights = np.zeros(_PARTICLES)
        self.pose, self.fit, self.age = pose, fit, 0.0

    def settle(self, random: "np.random.Generator") -> None:
        """Take the middle of the particles as the place. Draw them anew where too few of them count."""
        weights = np.exp(self.log_weights - self.log_weights.max())
        weights /= weights.sum()
        x, y, yaw = (float(each) for each in self.poses @ weights)
        self.pose = Pose(x, y, math.remainder(yaw, math.tau))
        if 1.0 / (weights @ weights) <= _EFFECTIVE * _PARTICLES:
            edges = (np.arange(_PARTICLES) + random.random()) / _PARTICLES
            self.poses = self.poses[:, np.searchsorted(weights.cumsum(), edges).clip(0, _PARTICLES - 1)]
            self.log_weights = np.zeros(_PARTICLES)


class EquivalentPlaces:
    """The equivalent places of one search."""

    def __init__(self, floor: Floor) -> None:
        self._floor = floor
        self._random = np.random.default_rng(0)
        self._places: list[_Place] = []
        self._best: Pose | None = None
        self._fit = Fit()
        """How much the best place explains, whichever place that is."""

    @property
    def poses(self) -> list[Pose]:
        return [place.pose for place in self._places]

    def follow(
        self, best: Pose | None, stride: Stride, beams: Sequence[Beam], candidates: Iterable[Pose], *, known: bool
    ) -> None:
        """Go along with the robot.

        `candidates`: other places that particles have. `known`: the best place before was a candidate or localized.
        """
        step = Pose(stride.x, stride.y, stride.turn)
        before = self._best
        self._best = here = best if best is not None or before is None else step.placed_in(before)
        if before is None or here is None:
            return
        shift = here.seen_from(before)
        if math.dist(shift[:2], step[:2]) <= _LEAP and abs(math.remainder(shift.yaw - step.yaw, math.tau)) <= _LEAP:
            step = shift
        elif known:
            self._places.append(_Place(before, self._fit.copy(), self._random))
        self._fit.add(compare(self._floor, here, beams), stride.effort)
        if self._places:
            self._move(step, stride.effort)
            self._weigh(beams)
        for place in self._places:
            place.settle(self._random)
            place.age += stride.effort
            if place.age < _YOUNG:
                place.fit = self._fit.copy()
            else:
                place.fit.add(compare(self._floor, place.pose, beams), stride.effort)
        left = (place for place in self._places if place.fit.share > self._fit.share - _WORSE)
        self._places = []
        for place in sorted(left, key=lambda place: place.fit.share, reverse=True):
            self._add(place, here)
        for pose in candidates:
            self._add(_Place(pose, self._fit.copy(), self._random), here)

    def _add(self, place: _Place, here: Pose) -> None:
        """Keep it where it is a place of its own."""
        if len(self._places) < _MOST and not any(are_near(place.pose, other) for other in (here, *self.poses)):
            self._places.append(place)

    def _move(self, step: Pose, effort: float) -> None:
        """Move the particles of all equivalent places as the robot moves, and let them wander a little."""
        poses = np.stack([place.poses for place in self._places], 1)
        cos, sin = np.cos(poses[2]), np.sin(poses[2])
        poses += np.array([cos * step.x - sin * step.y, sin * step.x + cos * step.y, np.full_like(cos, step.yaw)])
        poses += math.sqrt(effort) * _WANDERS * self._random.standard_normal(poses.shape)
        for number, place in enumerate(self._places):
            place.poses = poses[:, number]

    def _weigh(self, beams: Sequence[Beam]) -> None:
        """Weigh the particles of all equivalent places by what was heard."""
        x, y, yaw = np.stack([place.poses for place in self._places], 1)
        log = np.where(self._floor.space.holds(x, y), 0.0, OUTSIDE)
        for model, alike in self._floor.sonars.alike(beams):
            ahead, aside, turn, heard, share, _ = np.array(alike, np.float32).T[:, :, None, None]
            cos, sin = np.cos(yaw), np.sin(yaw)
            expected = model.table.expected(x + cos * ahead - sin * aside, y + sin * ahead + cos * aside, yaw + turn)
            log += (share * model.likely[heard.astype(np.intp), expected]).sum(0)
        for place, more in zip(self._places, log, strict=True):
            place.log_weights = place.log_weights + more
