"""Motion over the floor from pictures alone: corners that are followed, and the motion that explains them.

After Campbell, Sukthankar, Nourbakhsh and Pahwa, "A Robust Visual Odometry and Precipice Detection System Using
Consumer-grade Monocular Vision", 2005. Corners on the floor (Shi and Tomasi 1994) of a key picture are found again in
each later one (Lucas and Kanade 1981, in a pyramid), and their motion is told since the key picture.
"""

import math
from typing import Any, Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from giraff_core.kinematics.pose import Pose
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_vision import reasons
from giraff_vision.ground import Array, Grey, Ground
from giraff_vision.repetition import Repetition
from giraff_vision.rigid_motion import Refined, consensus, refined

Six = tuple[float, float, float, float, float, float]

_CORNERS: Final = 90
"""Number of corners in each band of the floor."""
_SPACING: Final = 9
"""px between corners."""
_QUALITY: Final = 0.02
_LEAST_CORNER: Final = 2.7e-4
"""Smallest eigenvalue of a corner's gradients. Below it noise makes the corners."""
_BLOCK: Final = 5
_WINDOW: Final = (15, 15)
_LEVELS: Final = 2
_STOP: Final = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 12, 0.02)
_UNLIKE: Final = 14.0
"""Grey levels by which the surroundings of a corner may differ from those in the key picture."""
_ABOVE: Final = 0.7
"""Share of the first row of the floor: corners are followed so far above it while the robot backs away."""
_LEAST_GRADIENT: Final = 1e-4
_RIM: Final = 3
"""px at the edges of a picture."""
_FEWEST: Final = 22
_KEPT: Final = 0.4
"""Share of the corners still in view that must have been followed."""
_AGREE: Final = 0.5
"""Share of the followed corners that must move alike."""
_RIVAL: Final = 0.6
"""Share of these, of corners that move alike in another way, from which two motions are seen."""
_SPREAD: Final = 0.08
"""m. Standard deviation of the corners' places, on either axis of the floor."""
_SURE: Final = 0.002
"""m. Largest standard deviation of a measurement, on either axis. The key picture stays where it is larger."""
_KEY_WAY: Final = 0.25
"""m from a key picture to the next."""
_KEY_TURN: Final = 0.2
"""rad from a key picture to the next."""
_WORN: Final = 0.4
"""Share of its corners that is left when a key picture is replaced by the next."""
_EVEN_OVER: Final = (21, 21)
"""px."""
_GAIN: Final = 3.0
_MIDDLE: Final = 128.0
"""Grey that stands for neither darker nor lighter."""
_MOST: Final = 30.0
"""Grey levels, with the gain, by which the pattern counts."""
_DARK: Final = 18.0
"""Mean grey of the floor's rows."""
_BRIGHT: Final = 250
_MOST_BRIGHT: Final = 0.3
"""Share of pixels."""
_BLACK: Final = 26
_MOST_BLACK: Final = 0.45
"""Share of the floor's rows, which are taken as `_CELLS`."""
_CELLS: Final = (8, 5)
_BLURRED: Final = 0.3
"""Share of the key picture's sharpness."""
_HERE: Final = Pose(0.0, 0.0, 0.0)


class PictureMotion(NamedTuple):
    """What one picture tells."""

    reason: Trouble
    """NO_TROUBLE: the motion is a measurement."""
    key: int
    """Number of the key picture that the motion is since."""
    motion: Pose | None = None
    """None: no motion was found. With a reason, the motion is not sure."""
    covariance: Six = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    tracked: Array = np.zeros((0, 2))
    """Pixels of the corners that move as the motion has it, (n, 2)."""
    rejected: Array = np.zeros((0, 2))
    """Pixels of the corners that do not, (n, 2)."""
    repeats: bool = False
    """The key picture's floor repeats: what the picture takes for this motion may be another one."""


class VisualOdometer:
    """Follows the pictures of one camera, of one size."""

    def __init__(self, ground: Ground) -> None:
        self.ground = ground
        rows = np.flatnonzero(ground.mask.any(axis=1))
        self._rows = slice(int(rows[0]), int(rows[-1]) + 1) if len(rows) else slice(0, 0)
        self.key = -1
        """Number of the key picture that the next picture's motion will be since; -1: there is none yet."""
        self._repetition: Repetition | None = None
        self._repeats = False
        self._chance = np.random.default_rng(0)
        self._corners = np.zeros((0, 2))
        """Corners that are followed: floor, m in `base_link` at the key picture."""
        self._found = 0
        self._sharpness = 0.0
        self._key_picture: Grey | None = None
        """None: there was no picture yet, or the last one shows nothing."""
        self._motion = np.zeros(5)
        self._renews = False
        self._step = _HERE
        """Motion from the picture before the last to the last."""

    def on_picture(self, grey: Grey) -> PictureMotion:
        """Return what the next picture tells. `grey`: (rows, columns) of the ground's size."""
        if unfit := self._unfit(grey):
            self._key_picture = None
            return self._none(unfit)
        sharpness = self._sharpness_of(grey)
        grey = _evened(grey)
        seen = (
            self._none(reasons.FIRST) if self._key_picture is None else self._follow(self._key_picture, grey, sharpness)
        )
        seen = seen._replace(repeats=self._repeats)
        is_lost = bool(seen.reason) and seen.motion is None
        if is_lost or self._renews or self._is_worn():
            self._begin(grey, sharpness)
        if is_lost:
            self._step = _HERE
        return seen

    def renew(self) -> None:
        """Make the next picture the key picture."""
        self._renews = True

    def _begin(self, grey: Grey, sharpness: float) -> None:
        """Make the present picture the key picture."""
        self._corners = self.ground.floor(self._corners_of(grey))
        self._renews = False
        self._found, self._sharpness, self._key_picture = len(self._corners), sharpness, grey
        self._motion = np.zeros(5)
        self._repetition = self._repetition or Repetition(self.ground)
        self._repeats = self._repetition.is_in(grey)
        self.key += 1

    def _none(self, reason: Trouble) -> PictureMotion:
        return PictureMotion(reason, max(0, self.key))

    def _unfit(self, grey: Grey) -> Trouble:
        """Why nothing can be seen in this picture; NO_TROUBLE: something may be."""
        if not self.ground.bands:
            return reasons.NO_FLOOR
        floor = grey[self._rows]
        if floor.mean() < _DARK:
            return reasons.DARK
        if (floor > _BRIGHT).mean() > _MOST_BRIGHT:
            return reasons.OVEREXPOSED
        if (cv2.resize(floor, _CELLS, interpolation=cv2.INTER_AREA) < _BLACK).mean() > _MOST_BLACK:
            return reasons.COVERED
        return NO_TROUBLE

    def _sharpness_of(self, grey: Grey) -> float:
        return float(cv2.Laplacian(cv2.GaussianBlur(grey[self._rows], (0, 0), 1.0), cv2.CV_32F).var())

    def _corners_of(self, grey: Grey) -> Array:
        """Return where corners on the floor are, px, (n, 2)."""
        rows = self._rows
        soft = cv2.GaussianBlur(grey[rows], (0, 0), 1.0)
        found = [np.zeros((0, 2))]
        for band in self.ground.bands:
            # None where there are no corners, whatever its types say.
            corners: Any = cv2.goodFeaturesToTrack(
                soft, _CORNERS, _QUALITY, _SPACING, mask=band[rows], blockSize=_BLOCK
            )
            if corners is not None:
                found.append(np.asarray(corners, np.float64)[:, 0])
        pixels = np.concatenate(found)
        strength = np.asarray(cv2.cornerMinEigenVal(soft, _BLOCK))
        column, row = pixels.astype(np.intp).T
        return np.asarray(pixels[strength[row, column] > _LEAST_CORNER] + np.array([0.0, rows.start]))

    def _follow(self, key: Grey, grey: Grey, sharpness: float) -> PictureMotion:
        """Find the corners of the key picture again, in it as it would look from where the robot is expected."""
        ground, floor = self.ground, self._corners
        if len(floor) < _FEWEST:
            return self._none(reasons.FEATURELESS)
        expected = self._expected()
        guess = ground.seen(floor, expected[None])[0]
        inside = self._is_inside(guess)
        floor, guess = floor[inside], guess[inside].astype(np.float32)
        if len(floor) < _FEWEST:
            return self._none(reasons.FEW)
        found, is_found, unlike = cv2.calcOpticalFlowPyrLK(
            self._warped(key, expected),
            grey,
            guess[:, None],
            guess[:, None].copy(),
            winSize=_WINDOW,
            maxLevel=_LEVELS,
            criteria=_STOP,
            flags=cv2.OPTFLOW_USE_INITIAL_FLOW,
            minEigThreshold=_LEAST_GRADIENT,
        )
        pixels = np.asarray(found, np.float64)[:, 0]
        kept = (np.asarray(is_found)[:, 0] == 1) & (np.asarray(unlike)[:, 0] < _UNLIKE) & self._is_inside(pixels)
        tracked = int(kept.sum())
        if tracked < max(_FEWEST, _KEPT * len(floor)):
            if sharpness < _BLURRED * self._sharpness:
                return self._none(reasons.BLURRED)
            return self._none(reasons.FEW if tracked < _FEWEST else reasons.LOST)
        floor, places, sway = floor[kept], pixels[kept], expected[3:]
        best = consensus(ground, floor, places, sway, self._chance)
        fit = None if best is None else refined(ground, floor, places, best, sway)
        if best is None or fit is None:
            return PictureMotion(reasons.MOVING, self.key, rejected=places)
        tracked, rejected = places[fit.agrees], places[~fit.agrees]
        if reason := _doubt(fit, best.rival, floor[fit.agrees]):
            return PictureMotion(reason, self.key, tracked=tracked, rejected=rejected)
        motion = _pose_of(fit.motion)
        self._step = motion.seen_from(_pose_of(self._motion))
        self._motion, self._corners = fit.motion, floor[fit.agrees]
        covariance = tuple(fit.covariance[np.triu_indices(3)].tolist())
        is_sure = max(fit.covariance[0, 0], fit.covariance[1, 1]) < _SURE**2
        return PictureMotion(NO_TROUBLE if is_sure else reasons.UNSURE, self.key, motion, covariance, tracked, rejected)

    def _expected(self) -> Array:
        """Return the motion since the key picture, if the robot goes on as between the last two pictures."""
        return np.array([*self._step.placed_in(_pose_of(self._motion)), *self._motion[3:]])

    def _warped(self, key: Grey, motion: Array) -> Grey:
        """Return the floor of the key picture as it looks after a motion: what is left to be found is small.

        Corners would else seem to move too little: a window on the floor has more contrast at its far side, which moves
        less.
        """
        before, after = self.ground.projections(np.stack([np.zeros(5), motion]))
        size = self.ground.width, self.ground.height
        there = before @ np.linalg.inv(after)
        flags = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
        return np.asarray(cv2.warpPerspective(key, there, size, flags=flags, borderMode=cv2.BORDER_REPLICATE), np.uint8)

    def _is_inside(self, pixels: Array) -> NDArray[np.bool_]:
        (column, row), ground = pixels.T, self.ground
        is_across = (column > _RIM) & (column < ground.width - 1 - _RIM)
        is_down = (row > _ABOVE * self._rows.start) & (row < ground.height - 1 - _RIM)
        return np.asarray(is_across & is_down)

    def _is_worn(self) -> bool:
        """Whether it is time for the next key picture."""
        return (
            math.hypot(*self._motion[:2]) > _KEY_WAY
            or abs(self._motion[2]) > _KEY_TURN
            or len(self._corners) < max(_FEWEST, _WORN * self._found)
        )


def _pose_of(motion: Array) -> Pose:
    x, y, yaw = motion[:3].tolist()
    return Pose(x, y, yaw)


def _evened(grey: Grey) -> Grey:
    """Return the picture's fine pattern alone, without what is darker or lighter over larger parts of it.

    A lens gives less light at its rim, and that part of the picture does not move: corners would seem to move too
    little, on a faint floor by 1 % of the way. And the edge of a shadow is no more than the grain of a plank then.
    """
    strong = cv2.addWeighted(grey, _GAIN, cv2.blur(grey, _EVEN_OVER), -_GAIN, _MIDDLE)
    return np.asarray(np.clip(strong, _MIDDLE - _MOST, _MIDDLE + _MOST), np.uint8)


def _doubt(fit: Refined, rival: int, floor: Array) -> Trouble:
    """Why a motion is no measurement; NO_TROUBLE: it is one. `floor`: of the corners that move so."""
    moving, tracked = int(fit.agrees.sum()), len(fit.agrees)
    if moving < _FEWEST:
        return reasons.FEW
    if moving < _AGREE * tracked or rival > _RIVAL * moving:
        return reasons.MOVING
    if floor.std(axis=0).min() < _SPREAD:
        return reasons.BUNCHED
    return NO_TROUBLE
