"""The runs of a real robot through the odometry: see tests/data/optiodom/README.md."""

import csv
import math
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import msgspec
import pytest

from giraff_core.kinematics.calibration import Calibration
from giraff_core.kinematics.dead_reckoning import WHEEL_NOISE
from giraff_core.kinematics.differential_drive import DifferentialDrive
from giraff_core.live import Live
from giraff_odometry.config import OdometryConfig
from giraff_odometry.policy import Estimate, OdometryPolicy, advance
from giraff_schemas.messages import Odometry, Wheels
from tests.unit.odometry.robots import ROBOT, wheels

DATA = Path(__file__).parents[2] / "data" / "optiodom"
END_ERRORS = {
    "square-a": (0.011, 0.015, 0.012, 0.033, 0.031, 0.027),
    "square-b": (0.025, 0.019, 0.027, 0.108, 0.104, 0.104),
}
"""m, as published with the nominal geometry, rounded."""

RUNS = [(session, run) for session, errors in END_ERRORS.items() for run in range(1, len(errors) + 1)]
CONFIG = OdometryConfig()

Row = tuple[float, float, float, float, int, int]
"""Time s; true x m, y m, heading rad; counts of the right and the left wheel since the row before."""


@cache
def metadata(session: str) -> dict[str, list[str]]:
    with (DATA / f"{session}_metadata.csv").open(newline="") as file:
        return {name: values for name, *values in csv.reader(file)}


@cache
def rows(session: str, run: int) -> list[Row]:
    with (DATA / f"{session}_run-{run:02}.csv").open(newline="") as file:
        return [
            (float(time), float(x), float(y), float(yaw), int(right), int(left))
            for time, x, y, yaw, right, left in csv.reader(file)
        ]


def geometry(session: str) -> tuple[float, float]:
    """Nominal track width (m) and counts per metre."""
    known = metadata(session)
    counts_per_turn = float(known["ngear"][0]) * float(known["encRes"][0])
    return float(known["Li"][0]), counts_per_turn / (math.pi * float(known["Di"][0]))


def travels(session: str, run: int) -> Iterator[tuple[float, float]]:
    """Left and right m of each row after the first, which is the start."""
    _, counts_per_metre = geometry(session)
    for *_, right, left in rows(session, run)[1:]:
        yield left / counts_per_metre, right / counts_per_metre


@cache
def integrated(session: str, run: int) -> Estimate:
    track_width, _ = geometry(session)
    drive = DifferentialDrive(track_width, max_wheel_speed=1.0)
    estimate = Estimate()
    for left, right in travels(session, run):
        estimate = advance(estimate, left, right, drive, WHEEL_NOISE)
    return estimate


def integrated_finely(session: str, run: int, substeps: int = 100) -> tuple[float, float]:
    """The same counts with no arc in sight: constant speed and turn in each row, in a hundred straight pieces."""
    track_width, _ = geometry(session)
    x = y = yaw = 0.0
    for left, right in travels(session, run):
        piece, turn = (left + right) / 2.0 / substeps, (right - left) / track_width / substeps
        if turn == 0.0:
            x += piece * substeps * math.cos(yaw)
            y += piece * substeps * math.sin(yaw)
            continue
        # The pieces' directions turn by the same small rotation each: cheaper than a sine for every one.
        step_cos, step_sin = math.cos(turn), math.sin(turn)
        cos, sin = math.cos(yaw + turn / 2.0), math.sin(yaw + turn / 2.0)
        for _ in range(substeps):
            x += piece * cos
            y += piece * sin
            cos, sin = cos * step_cos - sin * step_sin, sin * step_cos + cos * step_sin
        yaw += turn * substeps
    return x, y


def as_reports(session: str, run: int) -> list[Wheels]:
    """The run as the base board would have told it: counters and a clock, all about to wrap."""
    left = right = (1 << 31) - 1000
    start_us = (1 << 32) - 20_000_000
    samples = []
    for time, *_, right_counts, left_counts in rows(session, run):
        left, right = left + left_counts, right + right_counts
        samples.append(wheels(left, right, start_us + round(time * 1e6), robot_s=time))
    return samples


@cache
def followed(session: str, run: int) -> Odometry:
    """The last word of odometry on the whole run."""
    track_width, counts_per_metre = geometry(session)
    robot = msgspec.structs.replace(
        ROBOT, track_width=track_width, ticks_per_metre=counts_per_metre, calibration=Calibration()
    )
    odometry = OdometryPolicy(Live(CONFIG), robot)
    answers = [odometry.on_wheels(sample) for sample in as_reports(session, run)]
    assert answers[-1] is not None
    assert odometry.breaks == 0
    return answers[-1]


def end_error(session: str, run: int, x: float, y: float) -> float:
    _, true_x, true_y, *_ = rows(session, run)[-1]
    return math.dist((x, y), (true_x, true_y))


@pytest.mark.parametrize(("session", "run"), RUNS)
def test_the_end_error_is_the_published_one(session: str, run: int) -> None:
    end = integrated(session, run)
    error = end_error(session, run, end.x, end.y)
    print(f"{session} run {run}: end error {error:.4f} m after {end.path:.2f} m")
    assert error == pytest.approx(END_ERRORS[session][run - 1], abs=0.0005)


@pytest.mark.parametrize(("session", "run"), RUNS)
def test_the_end_is_that_of_an_independent_integration(session: str, run: int) -> None:
    end = integrated(session, run)
    fine = integrated_finely(session, run)
    print(f"{session} run {run}: {1e6 * math.dist((end.x, end.y), fine):.2f} um apart")
    assert math.dist((end.x, end.y), fine) < 0.001


@pytest.mark.parametrize(("session", "run"), RUNS)
def test_counters_that_wrap_on_the_way_end_at_the_same_place(session: str, run: int) -> None:
    end = integrated(session, run)
    told = followed(session, run)
    assert (told.x, told.y) == pytest.approx((end.x, end.y), abs=1e-9)


@pytest.mark.parametrize(("session", "run"), RUNS)
def test_the_error_is_within_what_the_covariance_says(session: str, run: int) -> None:
    """Three standard deviations of a robot that nobody has calibrated."""
    end = followed(session, run)
    xx, _, _, yy, _, _ = end.covariance
    assert end_error(session, run, end.x, end.y) < 3.0 * math.sqrt(xx + yy)
