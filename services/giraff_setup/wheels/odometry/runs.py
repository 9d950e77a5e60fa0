"""A run of the robot whose way was measured: what a calibration is fitted to, or checked on.

The exact arcs of odometry tell where its counts lead, whole runs at a time.
"""

import math
from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from giraff_core.kinematics.calibration import Scales

Floats = NDArray[np.float64]

SIDES: Final = (-1.0, 1.0)
"""What a metre of the left and of the right wheel does to the heading, times the track."""


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


def travels(run: Run, geometry: Geometry, scales: Scales) -> tuple[Floats, Floats]:
    """m that the left and the right wheel have rolled in each row."""
    per_count = 1.0 / geometry.ticks_per_metre
    return run.left * (per_count * scales.left_wheel), run.right * (per_count * scales.right_wheel)


def path(run: Run, geometry: Geometry, scales: Scales) -> Floats:
    """Shape (rows + 1, 3): x (m), y (m) and yaw (rad, going on past whole turns) after each row, from 0, 0, 0."""
    left, right = travels(run, geometry, scales)
    distance, turn = (left + right) / 2.0, (right - left) / (geometry.track_width * scales.track)
    yaw = np.concatenate(([0.0], np.cumsum(turn)))
    middle, chord = yaw[:-1] + turn / 2.0, distance * np.sinc(turn / math.tau)
    steps = np.stack((chord * np.cos(middle), chord * np.sin(middle)), axis=1)
    place = np.concatenate((np.zeros((1, 2)), np.cumsum(steps, axis=0)))
    return np.column_stack((place, yaw))


def way(run: Run, geometry: Geometry) -> Floats:
    """Shape (rows + 1,): m that the wheels have rolled on average up to each row, backwards and on the spot, too."""
    rolled = (np.abs(run.left) + np.abs(run.right)) / (2.0 * geometry.ticks_per_metre)
    return np.concatenate(([0.0], np.cumsum(rolled)))


def seen_from(start: Floats, end: Floats) -> Floats:
    """The pose `end` in the frame of the pose `start`; its yaw is their plain difference."""
    x, y, yaw = end - start
    cos, sin = math.cos(start[2]), math.sin(start[2])
    return np.array((cos * x + sin * y, cos * y - sin * x, yaw))


def as_array(pose: MeasuredPose) -> Floats:
    """x, y, yaw."""
    return np.array((pose.x, pose.y, pose.yaw))


def wrapped(angles: Floats) -> Floats:
    """`angles` less the whole turns in them: in [-pi, pi), whatever their shape."""
    return np.remainder(angles + np.pi, 2.0 * np.pi) - np.pi


def end_errors(runs: Sequence[Run], geometry: Geometry, scales: Scales) -> list[float]:
    """m between where each run ended and where odometry would have it with these scales."""
    return [
        math.hypot(*(path(run, geometry, scales)[run.measured[-1].row] - as_array(run.measured[-1]))[:2])
        for run in runs
    ]


def heading_errors(runs: Sequence[Run], geometry: Geometry, scales: Scales) -> list[float]:
    """rad, never negative: the same of the heading."""
    off = [path(run, geometry, scales)[run.measured[-1].row, 2] - run.measured[-1].yaw for run in runs]
    return [float(angle) for angle in np.abs(wrapped(np.array(off)))]
