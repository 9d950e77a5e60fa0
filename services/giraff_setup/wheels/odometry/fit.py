"""What wheels and track truly are, from runs whose way was measured: three scales, by weighted least squares.

J. Borenstein, L. Feng, Measurement and Correction of Systematic Odometry Errors in Mobile Robots, IEEE Transactions on
Robotics and Automation 12 (1996): unequal wheels (their Ed) bend what should be straight, a wrong track (their Eb)
turns too far or not far enough. On squares in one direction each can stand for the other; in the opposite direction
they differ. Their UMBmark takes both from the ends of squares. Here they and the size of the wheels are fitted to
everything that was measured on the way, with Gauss-Newton on the exact arcs, so that any course will do on which the
three differ. Whether they do is not asked of the course, but of the covariance of the fit.
"""

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np

from giraff_core.kinematics.calibration import Calibration, Covariance, Scales
from giraff_setup.condition import is_determined
from giraff_setup.wheels.odometry.runs import Floats, Geometry, Run, way
from giraff_setup.wheels.odometry.variance import SLIP, Linear, Noise, noise_of, solve
from giraff_setup.wheels.odometry.windows import LENGTH, WHOLE, Uncertainty, residuals, uncertainty, windows_of

_TELLING: Final = 6
"""Residuals beyond the three that are fitted, from which on they tell how large what is random is."""
_STEPS: Final = 30
_SETTLED: Final = 1e-4
"""Of a scale: below it the noise is not asked again, which hardly depends on the fit."""
_ARRIVED: Final = 1e-7
_BY: Final = 1e-6
"""Of a scale, for slopes."""
_LOWEST, _HIGHEST = 0.5, 2.0
"""What a scale can be at all."""
_COUPLED: Final = 0.9
"""Correlation of track and wheel ratio, as the ends of the runs tell them, from which on one may stand for the other:
all squares in one direction have 1.0, as many in the other 0.0, three to one 0.5."""
_UNKNOWN: Final = 1e3
"""Standard deviation of a scale that no run tells."""
_LOST: Final = 1e-12
"""Share of the largest information. Smaller information is rounding."""
_SIZE: Final = np.array((0.5, 0.5, 0.0))
_RATIO: Final = np.array((-1.0, 1.0, 0.0))
_TURN: Final = np.array((-0.5, -0.5, 1.0))
_MISSING: Final = (
    (_SIZE, "how far the wheels roll is not determined: add a straight line whose length is measured"),
    (_TURN, "how far the robot turns is not determined: add turns of known angle, as many to the left as to the right"),
    (_RATIO, "whether the wheels are equal is not determined: add a straight line with a measured heading at its end"),
)
"""What of the scales is too unsure, and what tells it."""


class UndeterminedError(Exception):
    """The runs do not tell what the scales are. One line: what is missing, and what to drive."""


class Fit(NamedTuple):
    """The scales that explain the runs best."""

    scales: Scales
    """On the geometry as built."""
    covariance: Covariance
    """Of (left_wheel, right_wheel, track)."""
    noise: Noise
    """What is random, as far as the residuals tell."""
    windows: int
    """How many were fitted, with three residuals each."""
    position_residual: float
    """m; root mean square of what remains of a window, ahead and to the side."""
    yaw_residual: float
    """rad; the same of the heading."""
    warnings: tuple[str, ...]
    """One line each."""

    @property
    def sd(self) -> tuple[float, float, float]:
        """Standard deviations of the three."""
        aa, _, _, bb, _, cc = self.covariance
        return aa**0.5, bb**0.5, cc**0.5

    @property
    def wheel_ratio(self) -> tuple[float, float]:
        """Right wheel over left, Borenstein's Ed, and its standard deviation."""
        left, right, _ = self.scales
        slope = np.array((-right / left**2, 1.0 / left, 0.0))
        return right / left, _spread(slope, full(self.covariance))

    @property
    def track_ratio(self) -> tuple[float, float]:
        """Track over the mean wheel, Borenstein's Eb, and its standard deviation."""
        left, right, track = self.scales
        mean = (left + right) / 2.0
        slope = np.array((-track / (2.0 * mean**2), -track / (2.0 * mean**2), 1.0 / mean))
        return track / mean, _spread(slope, full(self.covariance))


def fit(runs: Sequence[Run], geometry: Geometry) -> Fit:
    """The scales of these runs on `geometry` as built. Raises UndeterminedError.

    Where poses are measured all along, the ways between them are the residuals (`windows`), weighted by slip and play,
    which are told by what remains (`variance`). Where whole runs then end farther off than that lets expect, errors
    went together that were taken for independent: the covariance grows by as much.
    """
    _require_motion(runs, geometry)
    windows = _Windows(runs, geometry, LENGTH)
    least_slip, with_play = _what_is_told(windows)
    scales, noise, solution = np.array(geometry.scales), Noise(), None
    for _ in range(_STEPS):
        is_rough = solution is None or abs(solution.step).max() > _SETTLED
        if is_rough:
            windows.weigh(scales)
        lines = windows.about(scales)
        if is_rough:
            noise = noise_of(lines, noise, least_slip, with_play=with_play)
        solution = solve(lines, noise)
        scales = np.clip(scales + solution.step, _LOWEST, _HIGHEST)
        if abs(solution.step).max() < _ARRIVED:
            break
    else:  # a valley without a floor, or one that lies beyond what a robot can be
        raise UndeterminedError(_what_is_missing(solve(windows.about(np.array(geometry.scales)), noise).information))
    ends = _Windows(runs, geometry, WHOLE)
    ends.weigh(scales)
    whole = ends.about(scales)
    covariance = _covariance(solution.information, _growth(whole, noise))
    left = windows.residuals(scales)
    a, b, c = covariance.tolist()
    return Fit(
        scales=Scales(*(float(scale) for scale in scales)),
        covariance=(a[0], a[1], a[2], b[1], b[2], c[2]),
        noise=noise,
        windows=len(left),
        position_residual=float(np.sqrt(np.mean(left[:, :2] ** 2))),
        yaw_residual=float(np.sqrt(np.mean(left[:, 2] ** 2))),
        warnings=_warnings(solve(whole, noise).information),
    )


def full(covariance: Covariance) -> Floats:
    """3 x 3."""
    aa, ab, ac, bb, bc, cc = covariance
    return np.array(((aa, ab, ac), (ab, bb, bc), (ac, bc, cc)))


def _require_motion(runs: Sequence[Run], geometry: Geometry) -> None:
    if not runs:
        raise UndeterminedError("there is no run to fit to: add one")
    for run in runs:
        if not way(run, geometry)[-1]:
            raise UndeterminedError(f"{run.name}: no wheel turned in it: leave it out, or check the encoders' cables")


class _Windows:
    """The runs as residuals."""

    def __init__(self, runs: Sequence[Run], geometry: Geometry, length: float) -> None:
        self.runs, self._geometry = runs, geometry
        self._all = windows_of(runs, geometry, length)
        self._of_run = [[place for place, it in enumerate(self._all) if it.run == run] for run in range(len(runs))]
        self._uncertainties: list[Uncertainty] = []

    def __len__(self) -> int:
        return len(self._all)

    def residuals(self, scales: Floats) -> Floats:
        return residuals(self._all, self.runs, self._geometry, Scales(*scales))

    def weigh(self, scales: Floats) -> None:
        """Take the scales for about right in how the residuals are weighted."""
        self._uncertainties = [
            uncertainty([self._all[place] for place in places], run, self._geometry, Scales(*scales))
            for places, run in zip(self._of_run, self.runs, strict=True)
        ]

    def about(self, scales: Floats) -> list[Linear]:
        """Each run about these scales, with slopes by differences to both sides."""
        off = self.residuals(scales)
        ahead, behind = (np.stack([self.residuals(scales + by) for by in np.eye(3) * by], axis=2) for by in (_BY, -_BY))
        slopes = (ahead - behind) / (2.0 * _BY)
        return [
            Linear(off[places].ravel(), slopes[places].reshape(-1, 3), it)
            for places, it in zip(self._of_run, self._uncertainties, strict=True)
        ]


def _what_is_told(windows: _Windows) -> tuple[float, bool]:
    """The least slip that is believed, and whether play is told by the residuals, too.

    Less slip than odometry takes for granted is believed only of many residuals, and not beside marks, which hide it.
    Play shows where there are several windows a run.
    """
    is_marked = any(run.position_sd or run.yaw_sd for run in windows.runs)
    is_told = 3 * len(windows) - 3 >= _TELLING and not is_marked
    return 0.0 if is_told else SLIP, is_told and len(windows) >= 2 * len(windows.runs)


def _growth(whole: Sequence[Linear], noise: Noise) -> float:
    """How many times more the ends of whole runs are off, squared, than expected; 1 at least."""
    surplus = 3 * len(whole) - 3
    if surplus < _TELLING:
        return 1.0
    squares = (run.off @ np.linalg.solve(run.uncertainty.covariance(*noise), run.off) for run in whole)
    return max(1.0, float(sum(squares)) / surplus)


def _covariance(information: Floats, growth: float) -> Floats:
    """Of the scales. UndeterminedError where it is no better than that of a robot that nobody has calibrated."""
    if not is_determined(information, are_alike=True):
        raise UndeterminedError(_what_is_missing(information))
    covariance = np.linalg.inv(information).astype(np.float64) * growth
    if np.any(np.sqrt(np.diag(covariance)) > _limits()):
        raise UndeterminedError(_what_is_missing(information / growth))
    return (covariance + covariance.T) / 2.0


def _what_is_missing(information: Floats) -> str:
    """Which combination of the scales is least sure, with how sure it is, and what to drive."""
    root = _root(information)
    unsure = [(float(np.linalg.norm(combination @ root)), words) for combination, words in _MISSING]
    spread, words = max(unsure)
    limit = float(_limits()[0])
    amount = "not at all" if spread > 0.5 else f"to {100 * spread:.1f} %"
    return f"{words} (known {amount}; {100 * limit:.1f} % is no better than a robot that nobody has calibrated)"


def _root(information: Floats) -> Floats:
    """Return a matrix that gives the covariance when it is multiplied by its transpose.

    What is not determined has a large deviation instead of an infinite one.
    """
    values, axes = np.linalg.eigh(information)
    return np.asarray(axes / np.sqrt(np.where(values > _LOST * values[-1], values, _UNKNOWN**-2)))


def _limits() -> Floats:
    aa, _, _, bb, _, cc = Calibration().covariance
    return np.array((aa**0.5, bb**0.5, cc**0.5))


def _spread(combination: Floats, covariance: Floats) -> float:
    """Standard deviation of a combination of the scales."""
    return float(np.sqrt(combination @ covariance @ combination))


def _warnings(of_ends: Floats) -> tuple[str, ...]:
    """`of_ends`: what the ends of whole runs tell of the scales.

    Poses on the way tell straight pieces from corners, and so the two apart; but as far as the model of a robot goes.
    """
    # The size of the wheels taken as known: on closed courses no end tells it, which is another matter.
    root = _root(of_ends + np.outer(_SIZE, _SIZE) * 1e8)
    ratio, turn = _RATIO @ root, _TURN @ root
    together = float(ratio @ turn / (np.linalg.norm(ratio) * np.linalg.norm(turn)))
    if abs(together) < _COUPLED:
        return ()
    alike = f"a wrong track and unequal wheels look alike at the ends of these runs (correlation {together:+.2f})"
    return (f"{alike}: drive the course in the other direction as often",)
