"""A run of the robot whose way was measured: what a calibration is fitted to, or checked on."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from giraff_core.kinematics.calibration import Scales


class Geometry(NamedTuple):
    """What odometry goes by."""

    ticks_per_metre: float
    """Counts per metre of wheel travel, as built."""
    track_width: float
    """m, as built."""
    scales: Scales = Scales(1.0, 1.0, 1.0)
    """Factors on these: metres rolled per nominal metre of the left and of the right wheel; of the track."""


class MeasuredPose(NamedTuple):
    """Where the robot truly was at one moment of a run: `base_link` in the frame of the run's start."""

    row: int
    """After so many rows of counts; 0 is the start."""
    x: float
    """m ahead of the start."""
    y: float
    """m to the left of it."""
    yaw: float
    """rad to the left, known up to whole turns."""


class Run(NamedTuple):
    """One drive from rest to rest."""

    name: str
    """As its user calls it."""
    left: NDArray[np.float64]
    """Shape (rows,): counts of the left wheel since the row before, forward positive."""
    right: NDArray[np.float64]
    """The same of the right one."""
    measured: tuple[MeasuredPose, ...]
    """In order of their rows; one at least, the last one at the end."""
    position_sd: float
    """m; standard deviation of how a pose was measured, on either axis: of each in `measured`, and of the marks at the
    start, which count as a measurement, too. 0: the start is the frame itself, and what is measured differs by the
    robot's own randomness alone, which the fit then estimates from what remains."""
    yaw_sd: float
    """rad; the same of a heading."""
