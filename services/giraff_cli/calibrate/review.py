"""Whether runs that a person measured agree with each other: a wrong sign is found while it can still be measured."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

import numpy as np

from giraff_cli.calibrate.fit import UndeterminedError, fit
from giraff_cli.calibrate.runs import Geometry, Run
from giraff_cli.calibrate.variance import SLIP
from giraff_cli.calibrate.windows import WHOLE, residuals, uncertainty, windows_of

_ODD: Final = 16.3
"""Chi squared of three values, which one run of a thousand exceeds that is measured as well as it should be."""


def review(runs: Sequence[Run], geometry: Geometry) -> list[str]:
    """What a person should know before these runs are taken for good, one line each."""
    try:
        scales = fit(runs, geometry).scales
    except UndeterminedError as error:
        return [str(error)]
    windows = windows_of(runs, geometry, WHOLE)
    told = []
    for window, off in zip(windows, residuals(windows, runs, geometry, scales), strict=True):
        run = runs[window.run]
        covariance = uncertainty((window,), run, geometry, scales).covariance(SLIP, 0.0)
        if off @ np.linalg.solve(covariance, off) > _ODD:
            x, y, yaw = off
            told.append(
                f"{run.name} does not agree with the others: by them it ended {x:+.3f} m ahead of what was measured, "
                f"{y:+.3f} m aside, turned {math.degrees(yaw):+.1f} degrees; is a sign wrong, or did it slip?"
            )
    return told
