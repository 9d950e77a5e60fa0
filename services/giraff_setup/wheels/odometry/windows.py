"""Pieces of a run between two measured poses: what is measured of each, and how far all of them may be off together.

Odometry's errors add up along a path, so that its errors at two poses are never independent; those of the ways between
them are, but for what both share: the pose in between. A window is one such way, seen from where it begins. Its error
has two sources. The wheels' slip has a variance in proportion to what each wheel has rolled, as giraff_odometry has it
(R. Siegwart, I. Nourbakhsh, Introduction to Autonomous Mobile Robots, 2004, section 5.2.4). And each pose in between is
a little off: as its mark is measured; because counts come whole; because gears have play, so that a wheel is not quite
where its counts are. This does not add up: what one window has too much, the next one has too little.
"""

import itertools
from collections.abc import Iterator, Sequence
from typing import Final, NamedTuple

import numpy as np

from giraff_core.kinematics.calibration import Scales
from giraff_setup.wheels.odometry.runs import (
    SIDES,
    Floats,
    Geometry,
    MeasuredPose,
    Run,
    as_array,
    path,
    seen_from,
    travels,
    way,
    wrapped,
)

LENGTH: Final = 0.7
"""m of way of one window where poses are measured all along. On the recorded runs any length from 0.5 to 2 m does, for
those that were left out of the fit; with 0.3 m what shifts a window's ends is as large as what wheels and track do."""
WHOLE: Final = 1e9
"""m: longer than any run, which is then one window."""
_MOST: Final = 50
"""Of one run: longer ones have longer windows, or the fit takes minutes."""

_OWN: Final = 1e-9
"""Share of each variance that a window has for itself. Without it, where play is large beside what a count tells,
windows of one run would determine each other, and rounding would decide whether their covariance is regular."""


class Window(NamedTuple):
    """A piece of one run."""

    run: int
    """Index of the run."""
    begin: int
    """Rows of counts before it."""
    end: int
    measured: Floats
    """The end seen from the beginning: x m, y m, yaw rad."""


class Uncertainty(NamedTuple):
    """Of all windows of one run, 3 n x 3 n each: `known + slip * by_slip + play² * by_play`."""

    known: Floats
    by_slip: Floats
    """For each m² of variance per metre that a wheel rolls."""
    by_play: Floats
    """For each m² of variance of where a wheel is beside its counts."""

    def covariance(self, slip: float, play: float) -> Floats:
        """`play`: m, standard deviation."""
        covariance = self.known + slip * self.by_slip + play**2 * self.by_play
        return covariance + _OWN * np.diag(np.diag(covariance))


def windows_of(runs: Sequence[Run], geometry: Geometry, length: float = LENGTH, most: int = _MOST) -> list[Window]:
    """All runs in windows of about `length` m, `most` a run at most, as their measured poses allow."""
    return [
        Window(index, begin.row, end.row, seen_from(as_array(begin), as_array(end)))
        for index, run in enumerate(runs)
        for begin, end in _pieces(run, geometry, length, most)
    ]


def residuals(windows: Sequence[Window], runs: Sequence[Run], geometry: Geometry, scales: Scales) -> Floats:
    """Shape (windows, 3): what odometry makes of each window with these scales, less what was measured."""
    paths = [path(run, geometry, scales) for run in runs]
    off = np.array([seen_from(paths[it.run][it.begin], paths[it.run][it.end]) - it.measured for it in windows])
    off[:, 2] = wrapped(off[:, 2])
    return off


def uncertainty(windows: Sequence[Window], run: Run, geometry: Geometry, scales: Scales) -> Uncertainty:
    """Of the windows of one run, in their order; `scales`: how slip is carried along depends on the way a little."""
    size = 3 * len(windows)
    it = Uncertainty(np.zeros((size, size)), np.zeros((size, size)), np.zeros((size, size)))
    of_wheels = np.diag((0.5, 0.0, 2.0 / geometry.track_width**2))
    of_count = 1.0 / (12.0 * geometry.ticks_per_metre**2)
    of_mark = np.diag((run.position_sd**2, run.position_sd**2, run.yaw_sd**2))
    # To the side no count tells anything; a little keeps the matrix regular where a window is one straight row.
    of_mark += of_count * (of_wheels + np.diag((0.0, 0.5, 0.0)))
    before: Floats | None = None
    for index, window in enumerate(windows):
        here = slice(3 * index, 3 * index + 3)
        it.by_slip[here, here] = _of_slip(run, window.begin, window.end, geometry, scales)
        begin, end = _effects(window.measured)
        for matrix, of_pose in ((it.known, of_mark), (it.by_play, of_wheels)):
            matrix[here, here] += begin @ of_pose @ begin.T + end @ of_pose @ end.T
            if before is not None:
                there = slice(here.start - 3, here.start)
                matrix[there, here] = before @ of_pose @ begin.T
                matrix[here, there] = matrix[there, here].T
        before = end
    return it


def _effects(measured: Floats) -> tuple[Floats, Floats]:
    """Of an error of its first and of its last pose, each in its own frame, on a window."""
    x, y, yaw = measured
    cos, sin = np.cos(yaw), np.sin(yaw)
    begin = np.array(((-1.0, 0.0, y), (0.0, -1.0, -x), (0.0, 0.0, -1.0)))
    return begin, np.array(((cos, -sin, 0.0), (sin, cos, 0.0), (0.0, 0.0, 1.0)))


def _pieces(run: Run, geometry: Geometry, length: float, most: int) -> Iterator[tuple[MeasuredPose, MeasuredPose]]:
    """Neighbouring measured poses, so many left out that they are about `length` apart."""
    start = MeasuredPose(0, 0.0, 0.0, 0.0)
    known = (start, *(pose for pose in run.measured if pose.row > 0))
    gone = way(run, geometry)[[pose.row for pose in known]]
    count = max(1, min(round(float(gone[-1]) / length), most))
    chosen = np.searchsorted(gone, np.linspace(0.0, gone[-1], count + 1)[1:-1])
    ends = sorted({0, *(int(index) for index in chosen), len(known) - 1})
    for begin, end in itertools.pairwise(ends):
        yield known[begin], known[end]


def _of_slip(run: Run, begin: int, end: int, geometry: Geometry, scales: Scales) -> Floats:
    """Each row's error, carried to the window's end; from there as seen from its beginning."""
    piece = run._replace(left=run.left[begin:end], right=run.right[begin:end])
    places, track = path(piece, geometry, scales), geometry.track_width * scales.track
    middle = (places[1:] + places[:-1]) / 2.0
    lever_x, lever_y = middle[:, 1] - places[-1, 1], places[-1, 0] - middle[:, 0]
    covariance = np.zeros((3, 3))
    for side, rolled in zip(SIDES, travels(piece, geometry, scales), strict=True):
        turn = side / track
        effect = np.stack(
            (
                np.cos(middle[:, 2]) / 2.0 + turn * lever_x,
                np.sin(middle[:, 2]) / 2.0 + turn * lever_y,
                np.full(len(rolled), turn),
            )
        )
        covariance += (effect * np.abs(rolled)) @ effect.T
    return covariance
