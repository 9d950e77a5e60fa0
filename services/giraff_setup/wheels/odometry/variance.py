"""How large slip and play are, told by what remains of a fit: restricted maximum likelihood.

H. Patterson, R. Thompson, Recovery of inter-block information when block sizes are unequal, Biometrika 58 (1971): the
likelihood of the residuals once what the fit has taken from them is allowed for.
"""

import math
from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np

from giraff_core.kinematics.dead_reckoning import WHEEL_NOISE
from giraff_setup.condition import is_determined
from giraff_setup.wheels.odometry.runs import Floats
from giraff_setup.wheels.odometry.windows import Uncertainty

SLIP: Final = WHEEL_NOISE
"""m² per metre: what odometry takes the wheels' slip for, where the residuals are too few to tell."""
_FIRST_SLIP: Final = 1e-5
"""m² per metre, where the search begins: of two maxima, which hardly differ, it then finds that of the larger slip."""
_LEAST: Final = math.log(1e-12)
_MOST: Final = 0.0
"""Logarithms of what is searched, m² or m² per metre."""
_FINEST: Final = 0.05
_GAIN: Final = 1e-3
"""Of the cost: less is not worth a step."""


class Noise(NamedTuple):
    """What is random."""

    slip: float = _FIRST_SLIP
    """m² of variance per metre that a wheel rolls."""
    play: float = 0.0
    """m; standard deviation of where a wheel is beside its counts."""


class Linear(NamedTuple):
    """One run's residuals about some scales, as one column each."""

    off: Floats
    """Shape (n,)."""
    slopes: Floats
    """Shape (n, 3): by the scales."""
    uncertainty: Uncertainty


class Solution(NamedTuple):
    """Of the weighted least squares."""

    step: Floats
    """Shape (3,): to be added to the scales. Zero where the runs do not determine them."""
    information: Floats
    """3 x 3: the inverse of the step's covariance."""
    cost: float
    """Twice the negative logarithm of the restricted likelihood, but for a constant. Infinite where there is none."""


def solve(runs: Sequence[Linear], noise: Noise) -> Solution:
    """Generalised least squares of all runs, which are independent of each other."""
    information, pull = np.zeros((3, 3)), np.zeros(3)
    cost = 0.0
    for run in runs:
        root = np.linalg.cholesky(run.uncertainty.covariance(*noise))
        weighted = np.linalg.solve(root, np.column_stack((run.off, run.slopes)))
        off, slopes = weighted[:, 0], weighted[:, 1:]
        information += slopes.T @ slopes
        pull += slopes.T @ off
        cost += float(off @ off) + 2.0 * float(np.sum(np.log(np.diag(root))))
    if not is_determined(information, are_alike=True):
        return Solution(np.zeros(3), information, math.inf)
    step: Floats = np.linalg.solve(information, -pull).astype(np.float64)
    cost += float(pull @ step) + float(np.linalg.slogdet(information)[1])
    return Solution(step, information, cost if math.isfinite(cost) else math.inf)


def noise_of(runs: Sequence[Linear], start: Noise, least_slip: float, *, with_play: bool) -> Noise:
    """The noise of the greatest restricted likelihood, by a search that halves its steps."""
    lowest = math.log(least_slip) if least_slip else _LEAST
    at = (math.log(max(start.slip, least_slip)), 2.0 * math.log(start.play) if start.play else _LEAST)
    at = (at[0], math.log(start.slip) - 2.0) if with_play and not start.play else at

    def noise(place: tuple[float, float]) -> Noise:
        return Noise(math.exp(place[0]), math.exp(place[1] / 2.0) if with_play else 0.0)

    def moved(place: tuple[float, float], slip: float, play: float) -> tuple[float, float]:
        return min(max(place[0] + slip, lowest), _MOST), min(max(place[1] + play, _LEAST), _MOST)

    best, step = solve(runs, noise(at)).cost, 2.0
    while step > _FINEST:
        sides = (-step, 0.0, step) if with_play else (0.0,)
        cost, place = min(
            (solve(runs, noise(there)).cost, there)
            for there in {moved(at, slip, play) for slip in (-step, 0.0, step) for play in sides}
        )
        if cost < best - _GAIN:
            best, at = cost, place
        else:
            step /= 2.0
    return noise(at)
