"""What localization says against the truth, and how much of the way it said what."""

import math

import msgspec
import pytest

from giraff_core.kinematics.pose import Pose
from giraff_schemas.localization import LocalizationState
from giraff_telemetry.localization import WayByState, pose_text, shares_text
from giraff_telemetry.localization_error import LocalizationErrors
from giraff_telemetry.localization_summary import localization_rows, summarize_localization
from tests.unit.cli.map_poses import map_pose
from tests.unit.cli.samples import MS


def true_at(ms: int) -> Pose:
    """Along a line at 0.5 m/s that turns by 1 rad/s, over the seam of angles."""
    return Pose(1.0 + 0.5e-3 * ms, 2.0, math.remainder(3.0 + 1e-3 * ms, math.tau))


def drive(
    errors: LocalizationErrors, off: float, turned: float, state: LocalizationState = "localized", begin: int = 0
) -> None:
    """Two seconds in which it says to be `off` m beside, and `turned` rad."""
    for ms in range(begin, begin + 2001):
        if ms % 100 == 37:
            true = true_at(ms)
            errors.on_pose(map_pose(ms * MS, Pose(true.x, true.y + off, true.yaw + turned), state))
        if ms % 200 == 8:
            errors.see(ms * MS, true_at(ms))


def test_each_pose_is_compared_at_its_own_moment() -> None:
    errors = LocalizationErrors()
    drive(errors, 0.0, 0.0)
    assert errors.distances is not None
    assert errors.angles is not None
    assert errors.distances.worst == pytest.approx(0.0, abs=1e-9)
    assert errors.angles.worst == pytest.approx(0.0, abs=1e-9)


def test_an_error_shows_as_it_is_and_counts_only_while_it_is_localized() -> None:
    errors = LocalizationErrors()
    drive(errors, 3.0, 1.0, "ambiguous")
    never = errors.distances
    assert never is None
    assert errors.newest is not None
    assert errors.newest.state == "ambiguous"
    assert errors.newest.distance == pytest.approx(3.0)
    drive(errors, 0.05, -0.02, begin=2200)
    assert errors.distances == pytest.approx((0.05, 0.05, 0.05))
    assert errors.angles == pytest.approx((0.02, 0.02, 0.02))
    drive(errors, 1.0, 0.0, begin=4400)
    assert errors.distances is not None
    assert errors.distances.worst == pytest.approx(1.0)
    assert 0.04 < errors.distances.median <= errors.distances.p95 <= errors.distances.worst


def test_what_the_truth_does_not_reach_is_not_compared() -> None:
    errors = LocalizationErrors()
    errors.on_pose(map_pose(None))
    errors.on_pose(map_pose(100 * MS))
    errors.see(200 * MS, true_at(200))
    assert errors.newest is None, "there was no truth before it"
    errors.on_pose(map_pose(900 * MS))
    errors.see(400 * MS, true_at(400))
    assert errors.newest is None, "it is not there yet"
    errors.see(1000 * MS, true_at(1000))
    assert errors.newest is not None


def test_no_map_is_no_error() -> None:
    errors = LocalizationErrors()
    drive(errors, 1.0, 0.0, "no_map")
    assert errors.newest is None


def test_the_way_is_shared_among_the_states() -> None:
    way = WayByState()
    assert (way.shares, shares_text(way.shares)) == (None, "it has not moved")
    said: list[tuple[float, LocalizationState | None]] = [
        *((2.0, "lost"), (3.0, "lost"), (3.0, "ambiguous"), (4.0, "ambiguous"), (6.0, "localized")),
        *((1.0, "localized"), (1.5, None), (1.0, "lost")),
    ]
    for path, state in said:
        way.come(path, state)
    assert way.shares == {"lost": 0.25, "ambiguous": 0.25, "localized": 0.5}
    assert shares_text(way.shares) == "lost 25%, ambiguous 25%, localized 50% of the way"


def test_a_pose_is_told_in_a_line() -> None:
    there = Pose(1.5, -0.001, math.pi / 2)
    assert (
        pose_text(map_pose(0, there))
        == "localized | x 1.50 y 0.00 m, 90.0° | ± 0.05 m, 1.1° | explains 93% | way 0.0 m"
    )
    lost = pose_text(map_pose(0, there, "lost", "drive on", way=3.14, explained=0.0))
    assert lost == "lost | perhaps x 1.50 y 0.00 m, 90.0° | ± 0.05 m, 1.1° | explains 0% | way 3.1 m | drive on"
    assert pose_text(map_pose(0, there, "ambiguous")).startswith("ambiguous, 3 places | perhaps ")
    assert pose_text(map_pose(None, state="no_map", reason="no map is given")) == "no map | no map is given"


def test_the_summary_has_it_all() -> None:
    errors, way = LocalizationErrors(), WayByState()
    drive(errors, 0.05, -0.02)
    way.come(0.0, "lost")
    way.come(1.0, "lost")
    way.come(4.0, "localized")
    summary = summarize_localization(map_pose(0), way, errors)
    told = msgspec.json.decode(msgspec.json.encode(summary))
    assert told["shares"] == {"lost": 0.25, "localized": 0.75}
    assert (told["state"], told["map"], told["sigma_m"]) == ("localized", "hall", 0.05)
    assert (told["error"]["median_m"], told["error"]["end_deg"]) == (0.05, pytest.approx(1.146))
    assert localization_rows(summary) == [
        ("localization", "localized at x 1.50 y 2.20 m, 0.0°, ± 0.050 m, 1.1°"),
        ("knew its place", "lost 25%, localized 75% of the way"),
        ("place off by", "0.050 m, 1.1° median, 0.050 m, 1.1° p95, 0.050 m at most"),
        ("off at the end", "0.050 m, 1.1°"),
    ]


def test_what_is_not_known_is_left_out() -> None:
    nothing = summarize_localization(
        map_pose(None, state="no_map", reason="no map"), WayByState(), LocalizationErrors()
    )
    assert nothing.error is None
    rows = [("localization", "no map\nno map"), ("knew its place", "it has not moved")]
    assert localization_rows(nothing) == rows
    errors = LocalizationErrors()
    drive(errors, 2.0, 0.0, "lost")
    lost = summarize_localization(map_pose(0, state="lost", reason="drive on"), WayByState(), errors)
    assert lost.error is not None
    assert lost.error.median_m is None
    assert localization_rows(lost)[-1] == ("off at the end", "2.000 m, 0.0°")
