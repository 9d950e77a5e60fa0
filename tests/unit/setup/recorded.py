"""The recorded runs of a real robot, and a made-up one whose wheels are known."""

import csv
import math
from collections.abc import Sequence
from functools import cache

import numpy as np

from giraff_core.kinematics.calibration import Scales
from giraff_setup.wheels.odometry.fit import Fit, fit
from giraff_setup.wheels.odometry.runs import Floats, Geometry, MeasuredPose, Run, path
from tests.rules.repository import ROOT

DATA = ROOT / "tests" / "data" / "optiodom"
SESSIONS = ("square-a", "square-b")
GEOMETRY = Geometry(43.7 * 64 / (math.pi * 0.084), 0.2)
NOMINAL = Scales(1.0, 1.0, 1.0)
FITTED, CHECKED = (1, 2, 4, 5), (3, 6)


def recorded(session: str, numbers: Sequence[int], *, ends_only: bool = False) -> list[Run]:
    """Runs of a session, with all their poses or with the last one alone."""
    return [_recorded(session, number, ends_only) for number in numbers]


@cache
def fitted(session: str, numbers: tuple[int, ...]) -> Fit:
    """Fit these runs of a session, once per process."""
    return fit(recorded(session, numbers), GEOMETRY)


@cache
def table_of(run: str) -> Floats:
    """Read the file of one run, once per process."""
    with (DATA / f"{run}.csv").open(newline="") as file:
        table = np.array([[float(value) for value in row] for row in csv.reader(file)])
    table.setflags(write=False)
    return table


@cache
def _recorded(session: str, number: int, ends_only: bool) -> Run:
    rows = table_of(f"{session}_run-{number:02}")
    last = len(rows) - 1
    poses = tuple(MeasuredPose(row, *rows[row, 1:4]) for row in ([last] if ends_only else range(1, len(rows))))
    return Run(f"{session} {number}", rows[1:, 5], rows[1:, 4], poses, 0.0, 0.0)


def straight(metres: float) -> list[tuple[float, float]]:
    """What left and right wheel roll on a nominal robot, m, in pieces of 10 mm."""
    count = round(abs(metres) / 0.01)
    return [(metres / count, metres / count)] * count


def turn(radians: float) -> list[tuple[float, float]]:
    """The same on the spot, to the left."""
    count = round(abs(radians) / 0.05)
    arc = radians * GEOMETRY.track_width / 2.0 / count
    return [(-arc, arc)] * count


def square(side: float, sense: float) -> list[tuple[float, float]]:
    """One lap; `sense`: 1 to the left, -1 to the right."""
    return [piece for _ in range(4) for piece in (*straight(side), *turn(sense * math.pi / 2.0))]


def driven(
    name: str,
    course: Sequence[tuple[float, float]],
    scales: Scales,
    random: np.random.Generator,
    slip: float = 1e-5,
    marks: tuple[float, float] = (0.0, 0.0),
    geometry: Geometry = GEOMETRY,
) -> Run:
    """A robot with these scales on that course: whole counts, slip (m² per metre) and marks (m and rad) as said.

    Without marks its poses are measured all along, with marks at the end.
    """
    nominal = np.array(course)
    counts = np.diff(np.round(np.cumsum(nominal, axis=0) * geometry.ticks_per_metre), axis=0, prepend=0.0)
    rolled = counts * (scales.left_wheel, scales.right_wheel)
    rolled += random.normal(size=rolled.shape) * np.sqrt(slip * np.abs(rolled) * geometry.ticks_per_metre)
    truly = Run(name, rolled[:, 0], rolled[:, 1], (), 0.0, 0.0)
    poses = path(truly, geometry, Scales(1.0, 1.0, scales.track))
    position_sd, yaw_sd = marks
    if not position_sd:
        measured = tuple(MeasuredPose(row, *poses[row]) for row in range(1, len(poses)))
        return Run(name, counts[:, 0], counts[:, 1], measured, 0.0, 0.0)
    off_x, off_y, off_yaw = random.normal(size=3) * (position_sd, position_sd, yaw_sd)
    x, y, yaw = poses[-1]
    cos, sin = math.cos(off_yaw), math.sin(off_yaw)
    x, y = x - off_x, y - off_y
    end = np.array((cos * x + sin * y, cos * y - sin * x, yaw - off_yaw))
    end += random.normal(size=3) * (position_sd, position_sd, yaw_sd)
    return Run(name, counts[:, 0], counts[:, 1], (MeasuredPose(len(counts), *end),), position_sd, yaw_sd)
