"""Where the counts of a run lead: the exact arcs of odometry, whole runs at a time."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from giraff_core.kinematics.calibration import Scales
from giraff_setup.wheels.odometry.runs import Geometry, MeasuredPose, Run

Floats = NDArray[np.float64]

SIDES: Final = (-1.0, 1.0)
"""What a metre of the left and of the right wheel does to the heading, times the track."""


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
