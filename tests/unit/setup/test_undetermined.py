"""What measurements leave open is refused, whichever way this processor rounds a singular matrix."""

import math

import cv2
import numpy as np
import pytest

from giraff_core.senses import Camera
from giraff_schemas.motion import Turn
from giraff_setup.camera.lens import board_corners, fit_lens, lens_of
from giraff_setup.camera.picture import UnusableError
from giraff_setup.camera.sheet import find_sheet
from giraff_setup.condition import is_determined
from giraff_setup.ultrasonic.fit import UntoldError, wall_of
from giraff_setup.ultrasonic.fit import fit as fit_sensor
from giraff_setup.wheels.odometry.fit import UndeterminedError, fit
from giraff_setup.wheels.odometry.runs import Geometry
from giraff_setup.wheels.odometry.windows import uncertainty, windows_of
from tests.support.robots import ROBOT, ULTRASONIC
from tests.unit.setup.recorded import NOMINAL, driven, straight
from tests.unit.setup.walls import DrawnStand

FINEST = Geometry(200_000.0, 0.25)
"""The finest encoder that a robot file takes."""
LENS = lens_of(Camera(x=0.05, z=1.0, pitch=0.35))


def test_a_condition_counts_beside_the_sizes_of_the_unknowns() -> None:
    normal = np.array([[1.0, 1.0], [1.0, 1.0 + 1e-8]])
    units = np.diag([1e9, 1e-3])
    assert is_determined(normal)
    assert is_determined(units @ normal @ units)
    assert not is_determined(normal - np.diag([0.0, 1e-8 - 1e-12])), "regular for each processor, but told by rounding"
    for bad in (np.zeros((2, 2)), np.diag([1.0, math.nan]), np.diag([1.0, math.inf]), np.diag([1.0, -1.0])):
        assert not is_determined(bad)
    assert is_determined(np.diag([1.0, 1e-20]))
    assert not is_determined(np.diag([1.0, 1e-20]), are_alike=True)


def test_the_covariance_of_windows_is_regular_by_far_whatever_slip_and_play() -> None:
    run = driven("line", straight(5.0), NOMINAL, np.random.default_rng(1), geometry=FINEST)
    it = uncertainty(windows_of([run], FINEST), run, FINEST, NOMINAL)
    for slip in (0.0, 1e-12, 1.0):
        for play in (0.0, 1.0):
            assert is_determined(it.covariance(slip, play)), (slip, play)


@pytest.mark.parametrize("noise", [1e-5, 1e-12])
def test_a_line_that_is_measured_ever_better_tells_no_track(noise: float) -> None:
    lines = [
        driven(f"{seed}", straight(5.0), NOMINAL, np.random.default_rng(seed), noise, (1e-4, 1e-5), FINEST)
        for seed in (1, 2)
    ]
    with pytest.raises(UndeterminedError, match=r"how far the robot turns is not determined.*known not at all"):
        fit(lines, FINEST)


def test_rests_at_one_distance_tell_no_place() -> None:
    name, pose = next((name, pose) for name, pose in ULTRASONIC.items() if not pose.yaw)
    stand = DrawnStand(ROBOT, 1)
    wall = wall_of(stand.place(), stand.taped("left"), stand.taped("right"), ROBOT.track_width, ahead=True)
    rest = stand.listen([name], 30)
    turn = [
        echo for echo in stand.perform([Turn(angle=0.6), Turn(angle=-1.2), Turn(angle=0.6)])[1] if echo.sensor == name
    ]
    with pytest.raises(UntoldError, match="all its distances are alike"):
        fit_sensor(pose, wall, [rest] * 4, turn, 0.002)


def test_views_of_one_tilt_tell_no_focal_length() -> None:
    """They fit a whole valley of lenses. OpenCV ends somewhere in it, and says that it is sure."""
    views = [
        cv2.projectPoints(board_corners(), np.array([0.4, 0.0, 0.0]), np.array([x, y, 0.5]), LENS.matrix, np.zeros(5))[
            0
        ]
        for x in (-0.22, -0.14, -0.06, 0.02)
        for y in (-0.13, -0.05, 0.03)
    ]
    with pytest.raises(UnusableError, match="too alike"):
        fit_lens([np.asarray(view, dtype=np.float64).reshape(-1, 2) for view in views], 320, 240)


def test_a_sheet_with_a_hidden_edge_is_refused() -> None:
    grey = np.full((240, 320), 60, dtype=np.uint8)
    cv2.rectangle(grey, (125, 55), (211, 172), 200, -1)
    cv2.circle(grey, (208, 55), 7, 60, -1)
    cv2.circle(grey, (186, 55), 6, 255, -1)
    with pytest.raises(UnusableError, match="an edge of the sheet is not seen"):
        find_sheet(grey, LENS)
