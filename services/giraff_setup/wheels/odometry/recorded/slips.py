"""A recorded run that is not this robot's as it is written down: told by what would make it so."""

import math
from collections.abc import Callable
from typing import Final

import numpy as np

from giraff_core.kinematics.calibration import Scales
from giraff_setup.wheels.odometry.recorded.tables import (
    LEFT,
    NO_WHEEL_TURNED,
    RIGHT,
    TIME,
    YAW,
    RecordingError,
    X,
    Y,
    as_run,
    unwrapped,
)
from giraff_setup.wheels.odometry.runs import Floats, Geometry, Run, path, wrapped
from giraff_setup.wheels.odometry.windows import LENGTH, Window, residuals, windows_of

_OFF: Final = 0.25
"""Of what was measured: what odometry may be off within a window. With every scale at its limit it is less."""
_BETTER: Final = 0.4
"""Of that: what remains of it once the cause is found."""
_AT_REST: Final = 0.01
"""m that either wheel rolls at most while a robot stands and its encoders flutter."""
_GAP: Final = 1.5
"""Usual times between rows. A longer one is a gap."""
_LOST: Final = 0.02
"""m. Least that a wheel rolls uncounted in all gaps before rows count as missing."""
_BESIDE: Final = 0.015
"""m. From this distance from the middle between the wheels, a marker spoils a fit."""
_MARKER_FARTHEST: Final = 1.5
"""m from there. No marker is farther out; such a run is in another unit."""
_MARKER_WINDOWS: Final = 4
"""Least windows of a run, of three residuals each, that tell five unknowns."""
_MARKER_TURNED: Final = 1.0
"""m, root of the sum of squares. Least that the turns move a marker 1 m beside the middle."""
_SMALL_SCALES: Final = 0.3
"""m. A scale that is off by 10 % counts like a tenth of this in one window."""
_BY: Final = 1e-6
"""Change of a scale, for slopes."""
_TURNED: Final = 0.5
"""rad, root of the sum of squares: less says nothing of the sense in which a robot turned."""


def _exchanged(one: int, other: int) -> Callable[[Floats], Floats]:
    def change(table: Floats) -> Floats:
        order = list(range(table.shape[1]))
        order[one], order[other] = other, one
        return table[:, order]

    return change


def _times(factor: float, *columns: int) -> Callable[[Floats], Floats]:
    def change(table: Floats) -> Floats:
        changed = table.copy()
        changed[:, columns] *= factor
        return changed

    return change


def _in_metres(table: Floats) -> Floats:
    """Take x and y as millimetres if the robot went farther than a marker circles on a spin.

    A thousandth of that circle would look like a robot that spins in place.
    """
    is_beyond_marker = float(np.ptp(table[:, (X, Y)], axis=0).max()) > 2.0 * _MARKER_FARTHEST
    return _times(0.001, X, Y)(table) if is_beyond_marker else table


def _increments(table: Floats) -> Floats:
    changed = table.copy()
    changed[1:, (RIGHT, LEFT)] = unwrapped(np.diff(table[:, (RIGHT, LEFT)], axis=0))
    return changed


_SLIPS: Final[tuple[tuple[Callable[[Floats], Floats], str], ...]] = (
    (_exchanged(RIGHT, LEFT), "the two columns of counts are exchanged: right comes before left"),
    (_exchanged(X, Y), "x and y are exchanged: x comes first"),
    (_exchanged(X, YAW), "x and heading are exchanged: x, y, heading is the order"),
    (_exchanged(Y, YAW), "y and heading are exchanged: x, y, heading is the order"),
    (_times(math.pi / 180.0, YAW), "heading is in degrees: make it radians"),
    (_times(-1.0, YAW), "heading is counted clockwise: turn its sign"),
    (_in_metres, "x and y are in millimetres: make them metres"),
    (_times(-1.0, RIGHT, LEFT), "counts are negative forward: turn the sign of both"),
    (_increments, "counts are summed up: each row has those since the row before"),
)
"""What makes it right, and what was wrong then."""


def require_plausible(name: str, table: Floats, geometry: Geometry) -> None:
    """RecordingError where odometry and truth are apart by more than any calibration brings together."""
    rolled_at_most = float(np.abs(np.cumsum(table[1:, (RIGHT, LEFT)], axis=0)).max()) / geometry.ticks_per_metre
    if rolled_at_most < _AT_REST:
        raise RecordingError(f"{name}: {NO_WHEEL_TURNED}")
    run = as_run(name, table)
    off = _apart(run, geometry)
    is_plausible = off < _OFF and not _turns_opposite(run, geometry)
    if not is_plausible:
        apart, cause = min((_apart(as_run(name, change(table)), geometry), cause) for change, cause in _SLIPS)
        if apart < min(_BETTER * off, _OFF):
            raise RecordingError(f"{name}: {cause}")
    if cause := _gap(table, geometry) or _marker(run, geometry):
        raise RecordingError(f"{name}: {cause}")
    if is_plausible:
        return
    truly, rolled = float(np.sum(np.hypot(*np.diff(table[:, (X, Y)], axis=0).T))), _path_length(run, geometry)
    if rolled and not 0.7 < truly / rolled < 1.4:
        raise RecordingError(
            f"{name}: the robot went {truly:.2f} m and its wheels {rolled:.2f} m; are gear, counts of a turn and wheel "
            "diameter (ticks_per_metre) those of this robot, x and y the second and third column, in m?"
        )
    raise RecordingError(
        f"{name}: counts and true poses do not belong together (odometry is off by {100.0 * off:.0f} %); is it "
        "one run of this robot, with columns time, x, y, heading, right counts, left counts?"
    )


def _windows(run: Run, geometry: Geometry) -> list[Window]:
    """Return windows that turn a quarter at most. A whole turn looks like none, and moves no marker."""
    return windows_of([run], geometry, min(LENGTH, geometry.track_width * math.pi / 4.0), len(run.left))


def _apart(run: Run, geometry: Geometry) -> float:
    """What odometry is off in the windows, as a part of what was measured: root mean square of position, and of what
    the wheels roll in a turn.
    """
    windows = _windows(run, geometry)
    lengths = np.array((1.0, 1.0, geometry.track_width / 2.0))
    off = residuals(windows, [run], geometry, geometry.scales) * lengths
    measured = np.array([it.measured for it in windows])
    measured[:, 2] = wrapped(measured[:, 2])
    truly = float(np.sum((measured * lengths) ** 2))
    return float(np.sqrt(np.sum(off**2) / truly)) if truly else math.inf


def _gap(table: Floats, geometry: Geometry) -> str:
    """Return where rows are missing; empty: nowhere. The robot moves in a gap of time, and its counts do not say so."""
    times = np.diff(table[:, TIME])
    if not np.any(times > 0.0):
        return ""
    is_gap = times > _GAP * np.quantile(times[times > 0.0], 0.25)
    _, x, y, yaw = np.diff(table[:, (TIME, X, Y, YAW)], axis=0).T
    truly = np.hypot(x, y) + np.abs(wrapped(yaw)) * geometry.track_width / 2.0
    rolled = np.abs(table[1:, (RIGHT, LEFT)]).max(axis=1) / geometry.ticks_per_metre
    usual = float(np.sum(truly[~is_gap])) / (float(np.sum(rolled[~is_gap])) or 1.0)
    lost = np.where(is_gap, truly / (usual or 1.0) - rolled, 0.0)
    if float(np.sum(lost)) < max(_LOST, 0.3 * float(np.sum(rolled[is_gap]))):
        return ""
    row = int(np.argmax(lost))
    return (
        f"rows are missing before row {row + 2}: a wheel rolled {lost[row] + rolled[row]:.3f} m there and its counts "
        f"say {rolled[row]:.3f} m; add the lost counts to that row, or split the run there"
    )


def _marker(run: Run, geometry: Geometry) -> str:
    """Return where the marker is, if it is beside the middle between the wheels; empty: it is not.

    Turns then move it, and straight lines tell nothing. Wrong scales are fitted beside it: they are not its fault.
    Small ones are preferred: on a spin, unequal wheels move the middle as a marker at the side moves.
    """
    windows = _windows(run, geometry)
    lengths = np.array((1.0, 1.0, geometry.track_width / 2.0))

    def off_by(scales: Floats) -> Floats:
        return np.ravel(residuals(windows, [run], geometry, Scales(*scales)) * lengths)

    scales = np.array(geometry.scales)
    off = off_by(scales)
    slopes = np.column_stack([(off_by(scales + by) - off) / _BY for by in np.eye(3) * _BY])
    yaw = np.array([it.measured[2] for it in windows])
    moved = np.zeros((len(windows), 3, 2))
    moved[:, 0, 0] = moved[:, 1, 1] = np.cos(yaw) - 1.0
    moved[:, 1, 0], moved[:, 0, 1] = np.sin(yaw), -np.sin(yaw)
    off, slopes = np.concatenate((off, np.zeros(3))), np.vstack((slopes, _SMALL_SCALES * np.eye(3)))
    both = np.column_stack((slopes, np.vstack((moved.reshape(-1, 2), np.zeros((3, 2))))))
    unexplained, left = (off - it @ np.linalg.lstsq(it, off, rcond=None)[0] for it in (slopes, both))
    ahead, aside = -np.linalg.lstsq(both, off, rcond=None)[0][3:]
    is_told = len(windows) >= _MARKER_WINDOWS and np.linalg.norm(moved) > _MARKER_TURNED
    is_better = np.linalg.norm(left) < _BETTER * np.linalg.norm(unexplained)
    if not (is_told and is_better and _BESIDE < math.hypot(ahead, aside) < _MARKER_FARTHEST):
        return ""
    return (
        f"x and y are those of a marker a = {ahead:.3f} m ahead and b = {aside:.3f} m to the left of the middle "
        "between the wheels; write x - a cos(heading) + b sin(heading) and y - a sin(heading) - b cos(heading)"
    )


def _turns_opposite(run: Run, geometry: Geometry) -> bool:
    """Whether it turned to the one side by its wheels and to the other in truth."""
    yaw = path(run, geometry, geometry.scales)[:, 2]
    windows = _windows(run, geometry)
    rolled = np.array([yaw[it.end] - yaw[it.begin] for it in windows])
    truly = wrapped(np.array([it.measured[2] for it in windows]))
    is_turned = float(np.sum(truly**2)) > _TURNED**2 and float(np.sum(rolled**2)) > _TURNED**2
    return is_turned and float(np.sum(rolled * truly)) < 0.0


def _path_length(run: Run, geometry: Geometry) -> float:
    """m that the robot's middle went by its wheels."""
    return float(np.sum(np.abs(run.left + run.right))) / (2.0 * geometry.ticks_per_metre)
