"""Particles: where a robot may be, and what its wheels may be.

Each carries the scales of wheels and track that it takes the robot to have, beside its pose: the same on the whole way,
so that their errors do not average out. What odometry says of their uncertainty (`[robot.calibration]`) is what they
are drawn from.
"""

import math
from collections.abc import Sequence
from typing import Final

import numpy as np
import numpy.typing as npt

from giraff_core.kinematics.calibration import cholesky
from giraff_core.robot import RobotConfig
from giraff_localization.beams.ultrasonic import Beam, Sonars
from giraff_localization.free_space import Floats, FreeSpace
from giraff_localization.track import Stride

_DRIFT: Final = 0.06
"""Of their standard deviation, by which the scales wander in a metre: no wheel is the same on every floor."""
_LEAST_SD: Final = 0.003
"""Of a scale: a robot that was calibrated well is not the same on another floor."""
_SPREAD: Final = 0.02
_ASIDE: Final = 0.01
_TWIST: Final = 0.02
"""m, m and rad after a metre: what keeps particles apart, by which a map may be wrong here and right there."""
_SLIP: Final = 0.05
"""rad after a radian, of turns: what a tyre scrubs is another thing each time."""
OUTSIDE: Final = -1.5
"""Log-likelihood of a robot whose middle is where it cannot be."""
_BIN: Final = 0.25
_BIN_YAW: Final = math.radians(15.0)
_KLD_ERROR: Final = 0.03
_KLD_Z: Final = 2.33
"""D. Fox, KLD-Sampling: Adaptive Particle Filters, NIPS 2001: with 99 %, the error of the distribution is below 3 %."""
_EFFECTIVE: Final = 0.5
"""Share of the particles that may count for nothing before they are drawn anew."""
_KNOWN: Final = 0.8
"""Of those whose scales are drawn from others that have learned them."""

Weights = npt.NDArray[np.float64]


class Cloud:
    """So many particles. Shapes: poses and scales (3, n), weights (n)."""

    def __init__(self, space: FreeSpace, robot: RobotConfig, poses: Floats, random: "np.random.Generator") -> None:
        """`poses`: x, y, yaw of each."""
        self._space, self._random = space, random
        self._track, self._wheel_noise = robot.kinematics.track_width, robot.wheel_noise
        count = poses.shape[1]
        self.poses = poses
        root = np.array(cholesky(robot.calibration.covariance))
        self._scale_sds = np.maximum(np.sqrt((root**2).sum(1)), _LEAST_SD)[:, None].astype(np.float32)
        # On the found scales, so that what each particle has is a factor about 1.
        drawn = root @ random.normal(0.0, 1.0, (3, count)) / np.array(robot.calibration.scales)[:, None]
        self.scales: Floats = drawn.astype(np.float32)
        self.log_weights = np.zeros(count)
        self._wandered = 0.0
        """m, turns counted, since the scales were last let go a bit: those of two that were one must part."""
        self.evidence = 0.0
        """Log-likelihood of what was heard, by all particles together: the same measure for every cloud."""
        self.gain = 1.0
        """Exponent of what is heard: below 1, all are given more time."""

    @property
    def count(self) -> int:
        return len(self.log_weights)

    @property
    def weights(self) -> Weights:
        """Sum to 1."""
        weights = np.exp(self.log_weights - self.log_weights.max())
        normed: Weights = weights / weights.sum()
        return normed

    def learn_scales(self, other: "Cloud") -> None:
        """Most take their scales from these: a robot that was lifted keeps its wheels."""
        chosen = self._random.choice(other.count, self.count, p=other.weights)
        keep = self._random.random(self.count) < _KNOWN
        self.scales[:, keep] = other.scales[:, chosen][:, keep]

    def move(self, stride: Stride) -> None:
        """Go as odometry says, each by its own scales, with what is random in it."""
        random, count = self._random, self.count
        half = stride.turn * self._track / 2.0
        left, right = stride.forward - half, stride.forward + half
        left_scale, right_scale, track_scale = self.scales
        more = (left * left_scale + right * right_scale) / 2.0
        more_turn = (right * right_scale - left * left_scale) / self._track - stride.turn * track_scale
        wheels = self._wheel_noise * (stride.way + stride.turned * self._track / 2.0)
        missed_position, missed_yaw = stride.missed
        yaw_sd = math.sqrt(
            2.0 * wheels / self._track**2 + _SLIP**2 * stride.turned + _TWIST**2 * stride.effort + missed_yaw**2
        )
        along_sd = math.sqrt(wheels / 2.0 + _SPREAD**2 * stride.effort + missed_position**2)
        aside_sd = math.sqrt(_ASIDE**2 * stride.effort + missed_position**2)
        noise = random.standard_normal((3, count), np.float32)
        turn_error = more_turn + yaw_sd * noise[0]
        ahead = math.hypot(stride.x, stride.y) + math.copysign(1.0, stride.x) * more + along_sd * noise[1]
        aside = aside_sd * noise[2]
        heading = self.poses[2] + (math.atan2(stride.y, stride.x) + turn_error / 2.0)
        cos, sin = np.cos(heading), np.sin(heading)
        self.poses[0] += ahead * cos - aside * sin
        self.poses[1] += ahead * sin + aside * cos
        self.poses[2] += stride.turn + turn_error
        self._wandered += stride.effort

    def weigh(self, beams: Sequence[Beam], sonars: Sonars) -> None:
        """Take what was heard."""
        x, y, yaw = self.poses
        cos, sin = np.cos(yaw), np.sin(yaw)
        likelihood = np.where(self._space.holds(x, y), np.float32(0.0), np.float32(OUTSIDE))
        for model, alike in sonars.alike(beams):
            for beam in alike:
                expected = model.table.expected(
                    x + cos * beam.x - sin * beam.y, y + sin * beam.x + cos * beam.y, yaw + beam.yaw
                )
                likelihood += beam.share * model.likely[beam.reading][expected]
        before = _log_sum(self.log_weights)
        self.evidence += _log_sum(self.log_weights + likelihood) - before
        self.log_weights = self.log_weights + self.gain * likelihood

    def resample(self, least: int, most: int) -> None:
        """Draw anew where too few of them count, so many as the places need that are still likely."""
        weights = self.weights
        if 1.0 / (weights * weights).sum() <= _EFFECTIVE * self.count:
            self.draw(self._enough(weights, least, most))

    def draw(self, count: int) -> None:
        """So many of these, by their weights: low-variance sampling, Probabilistic Robotics, table 4.4."""
        edges = (np.arange(count) + self._random.random()) / count
        chosen = np.searchsorted(np.cumsum(self.weights), edges).clip(0, self.count - 1)
        wander = _DRIFT * math.sqrt(self._wandered) * self._scale_sds
        self.poses = self.poses[:, chosen]
        self.scales = self.scales[:, chosen] + wander * self._random.standard_normal((3, count), np.float32)
        self.log_weights, self._wandered = np.zeros(count), 0.0

    def sample(self, count: int) -> Floats:
        """Poses of so many of them, by their weights; fewer where there are no more."""
        count = min(count, self.count)
        edges = (np.arange(count) + 0.5) / count
        return self.poses[:, np.searchsorted(np.cumsum(self.weights), edges).clip(0, self.count - 1)]

    def join(self, other: "Cloud", share: float) -> None:
        """Become a mixture: `share` of the other's."""
        count = max(self.count, other.count)
        theirs = max(1, round(count * share))
        self.draw(count - theirs)
        other.draw(theirs)
        self.poses = np.hstack([self.poses, other.poses])
        self.scales = np.hstack([self.scales, other.scales])
        self.log_weights = np.zeros(count)

    def _enough(self, weights: Weights, least: int, most: int) -> int:
        """KLD-sampling, equation 7, of the bins that are occupied."""
        alive = weights > 0.05 / self.count
        x, y, yaw = self.poses[:, alive]
        column, row = np.floor(x / _BIN).astype(np.int64), np.floor(y / _BIN).astype(np.int64)
        heading = np.floor(yaw % math.tau / _BIN_YAW).astype(np.int64)
        bins = max(2, len(np.unique((column * 100_003 + row) * 31 + heading)))
        width = 2.0 / (9.0 * (bins - 1))
        count = (bins - 1) / (2.0 * _KLD_ERROR) * (1.0 - width + math.sqrt(width) * _KLD_Z) ** 3
        return int(min(most, max(least, count)))


def _log_sum(log_weights: Weights) -> float:
    most = float(log_weights.max())
    return most + math.log(float(np.exp(log_weights - most).sum()))
