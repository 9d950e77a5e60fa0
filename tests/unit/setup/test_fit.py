"""Three scales from runs: of a real robot, and of made-up ones whose scales are known."""

import math
from collections.abc import Sequence

import numpy as np
import pytest

import giraff_setup.wheels.odometry.fit
from giraff_core.kinematics.calibration import Calibration, Scales, cholesky
from giraff_setup.wheels.odometry.fit import Fit, UndeterminedError, fit
from giraff_setup.wheels.odometry.runs import Run, end_errors
from tests.unit.setup.recorded import (
    CHECKED,
    FITTED,
    GEOMETRY,
    NOMINAL,
    SESSIONS,
    driven,
    fitted,
    recorded,
    square,
    straight,
    turn,
)

EVERY = (1, 2, 3, 4, 5, 6)


def mean_end_errors(runs: Sequence[Run], found: Fit) -> tuple[float, float]:
    """m; nominal, and with what was found."""
    before, after = (float(np.mean(end_errors(runs, GEOMETRY, scales))) for scales in (NOMINAL, found.scales))
    return before, after


@pytest.mark.parametrize(("session", "left_over"), [("square-a", 0.5), ("square-b", 0.6)])
def test_runs_that_were_not_fitted_end_nearer(session: str, left_over: float) -> None:
    found = fitted(session, FITTED)
    before, after = mean_end_errors(recorded(session, CHECKED), found)
    print(f"{session}: {found}; checked {before:.4f} m -> {after:.4f} m")
    assert after <= left_over * before
    assert found.warnings == ()


@pytest.mark.parametrize(("session", "length"), [*zip(SESSIONS, (0.5, 2.0), strict=True)])
def test_that_does_not_hang_on_how_long_a_window_is(
    session: str, length: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(giraff_setup.wheels.odometry.fit, "LENGTH", length)
    before, after = mean_end_errors(recorded(session, CHECKED), fit(recorded(session, FITTED), GEOMETRY))
    print(f"{session} in windows of {length} m: {before:.4f} m -> {after:.4f} m")
    assert after <= 0.5 * before


@pytest.mark.parametrize(
    ("session", "other", "left_over"), [("square-a", "square-b", 0.5), ("square-b", "square-a", 1.0)]
)
def test_what_one_session_tells_holds_in_the_other(session: str, other: str, left_over: float) -> None:
    before, after = mean_end_errors(recorded(other, EVERY), fitted(session, FITTED))
    print(f"{session} on {other}: {before:.4f} m -> {after:.4f} m")
    assert after <= left_over * before


@pytest.mark.parametrize("session", SESSIONS)
def test_a_run_that_is_left_out_ends_nearer(session: str) -> None:
    """Of the fitted ones only. The scales that are found meanwhile scatter no more than they are said to."""
    errors, founds = [], []
    for left_out in FITTED:
        found = fitted(session, tuple(number for number in FITTED if number != left_out))
        errors.append(mean_end_errors(recorded(session, [left_out]), found))
        founds.append(found.scales)
    before, after = np.mean(errors, axis=0)
    scatter = np.sqrt(3.0 / 4.0 * np.sum((np.array(founds) - np.mean(founds, axis=0)) ** 2, axis=0))
    sd = np.array(fitted(session, FITTED).sd)
    print(f"{session}: {before:.4f} m -> {after:.4f} m; jackknife sd {scatter}, said {sd}")
    assert after <= 0.6 * before
    # Four runs tell a standard deviation to a factor of 2 or so.
    assert np.all(scatter < 2.0 * sd)


def test_both_sessions_find_the_same_robot() -> None:
    one, other = (fitted(session, FITTED) for session in SESSIONS)
    apart = np.array(one.scales) - np.array(other.scales)
    sds = np.hypot(one.sd, other.sd)
    print(f"apart {apart}, by {apart / sds} standard deviations")
    assert np.all(np.abs(apart) < 3.0 * sds)


@pytest.mark.parametrize("session", SESSIONS)
@pytest.mark.parametrize("numbers", [(1,), (5,), (1, 2, 3), (4, 5, 6)])
def test_one_direction_is_warned_about(session: str, numbers: tuple[int, ...]) -> None:
    [warning] = fitted(session, numbers).warnings
    assert "other direction" in warning


@pytest.mark.parametrize("session", SESSIONS)
@pytest.mark.parametrize("numbers", [(1, 4), (1, 2, 4), (1, 2, 3, 4)])
def test_both_directions_are_not(session: str, numbers: tuple[int, ...]) -> None:
    assert fitted(session, numbers).warnings == ()


@pytest.mark.parametrize(("session", "numbers"), [*zip(SESSIONS, (FITTED, (1,)), strict=True)])
def test_ends_of_closed_squares_alone_are_refused(session: str, numbers: tuple[int, ...]) -> None:
    """They fit best to a robot that does not move at all."""
    with pytest.raises(UndeterminedError, match="straight line whose length is measured"):
        fit(recorded(session, numbers, ends_only=True), GEOMETRY)


def test_straight_lines_alone_do_not_tell_the_track() -> None:
    lines = [driven(f"{number}", straight(5.0), NOMINAL, np.random.default_rng(number)) for number in range(3)]
    with pytest.raises(UndeterminedError, match="how far the robot turns"):
        fit(lines, GEOMETRY)


def test_turns_alone_do_not_tell_the_wheels() -> None:
    turns = [driven(f"{sense}", turn(sense * 18.0), NOMINAL, np.random.default_rng(1)) for sense in (-1, 1)]
    with pytest.raises(UndeterminedError, match="not determined"):
        fit(turns, GEOMETRY)


def test_a_run_without_motion_is_named() -> None:
    still = recorded("square-a", (1,))[0]
    still = still._replace(name="still", left=0.0 * still.left, right=0.0 * still.right)
    with pytest.raises(UndeterminedError, match="still: no wheel turned"):
        fit([*recorded("square-a", FITTED), still], GEOMETRY)
    with pytest.raises(UndeterminedError, match="no run"):
        fit([], GEOMETRY)


def honest(found: Sequence[Fit], true: Sequence[Scales]) -> None:
    """Errors are about as large as they are said to be: their weighted squares are 3 each, on average."""
    squares, single = [], []
    for it, scales in zip(found, true, strict=True):
        error = np.array(it.scales) - np.array(scales)
        root = np.array(cholesky(it.covariance))
        squares.append(float(np.sum(np.linalg.solve(root, error) ** 2)))
        single.append(error / it.sd)
        Calibration(covariance=it.covariance)
    spread = np.sqrt(np.mean(np.square(single), axis=0))
    print(f"errors over sd {spread}; weighted squares {np.mean(squares):.2f}, {max(squares):.1f} at most")
    assert np.all((spread > 0.6) & (spread < 1.3))
    assert 1.5 < np.mean(squares) < 4.5


def drawn(random: np.random.Generator) -> Scales:
    return Scales(*(1.0 + random.normal(size=3) * (0.01, 0.01, 0.03)))


def test_scales_that_are_known_are_found_as_surely_as_is_said_all_along() -> None:
    found, true = [], []
    for seed in range(8):
        random = np.random.default_rng(seed)
        scales = drawn(random)
        courses = [square(1.0, sense) for sense in (1, 1, -1, -1)]
        runs = [driven(f"{number}", course, scales, random) for number, course in enumerate(courses)]
        found.append(fit(runs, GEOMETRY))
        true.append(scales)
    honest(found, true)


def test_scales_that_are_known_are_found_as_surely_as_is_said_by_marks() -> None:
    found, true = [], []
    marks = (0.005, math.radians(0.5))
    for seed in range(12):
        random = np.random.default_rng(seed)
        scales = drawn(random)
        courses = [straight(5.0), straight(5.0), turn(6.0 * math.pi), turn(-6.0 * math.pi)]
        runs = [driven(f"{number}", course, scales, random, marks=marks) for number, course in enumerate(courses)]
        found.append(fit(runs, GEOMETRY))
        true.append(scales)
        assert found[-1].warnings == ()
    honest(found, true)
