"""Places that explain what is heard as well as the best one does."""

import math
from typing import Final

import numpy as np
import pytest

from giraff_core.kinematics.pose import Pose
from giraff_localization.beams.range_table import CLEAR
from giraff_localization.beams.ultrasonic import Beam
from giraff_localization.clusters import are_near
from giraff_localization.equivalent_places import EquivalentPlaces
from giraff_localization.track import Stride
from giraff_maps.floor_plan import FloorPlan
from tests.unit.localization.rooms import floor, outline

HALL: Final = FloorPlan(
    "hall",
    outline((0.0, 0.0), (8.0, 0.0), (8.0, 2.6), (0.0, 2.6))
    + outline((2.0, 0.0), (3.0, 0.0), (3.0, 0.7), (2.0, 0.7))
    + outline((6.0, 2.6), (5.0, 2.6), (5.0, 1.9), (6.0, 1.9)),
)
"""8 m by 2.6 m, with two boxes. Half a turn about its middle changes nothing."""
AHEAD: Final = Stride(x=0.1, y=0.0, turn=0.0, forward=0.1, way=0.1, turned=0.0, missed=(0.0, 0.0))
BACK: Final = AHEAD._replace(x=-0.1, forward=-0.1)


def turned(pose: Pose) -> Pose:
    """Return the place that half a turn about the middle of the hall takes it to."""
    return Pose(8.0 - pose.x, 2.6 - pose.y, math.remainder(pose.yaw + math.pi, math.tau))


def heard(pose: Pose) -> list[Beam]:
    """Return what four sensors hear at this place."""
    beams = []
    table = floor(HALL).sonars.models[0].table
    for yaw in (0.0, 0.8, math.pi / 2.0, -math.pi / 2.0):
        expected = int(table.expected(*(np.array([each]) for each in (pose.x, pose.y, pose.yaw + yaw)))[0])
        beams.append(Beam(0.0, 0.0, yaw, min(expected, CLEAR), 0.2))
    return beams


def drive(twins: EquivalentPlaces, here: Pose, stride: Stride, metres: float, candidate: Pose | None = None) -> Pose:
    """Return where the robot is after this way."""
    for number in range(round(metres / 0.1)):
        others = [candidate] if candidate is not None and number == 0 else []
        twins.follow(here, stride, heard(here), others, known=True)
        here = Pose(stride.x, stride.y, stride.turn).placed_in(here)
    return here


def test_a_place_turned_round_beside_the_best_is_a_twin() -> None:
    twins, here = EquivalentPlaces(floor(HALL)), Pose(3.75, 1.3, 0.0)
    drive(twins, drive(twins, here, AHEAD, 0.2), AHEAD, 0.5, turned(here))
    assert len(twins.poses) == 1


def test_a_twin_is_left_after_a_long_way_although_it_was_not_known_exactly() -> None:
    twins, here = EquivalentPlaces(floor(HALL)), Pose(1.0, 1.3, 0.0)
    here = drive(twins, here, AHEAD, 0.2)
    there = turned(here)
    here = drive(twins, here, AHEAD, 5.8, there._replace(x=there.x + 0.1, yaw=there.yaw + 0.12))
    for stride in (BACK, AHEAD, BACK, AHEAD):
        here = drive(twins, here, stride, 6.0)
    [pose] = twins.poses
    assert math.dist(pose[:2], turned(here)[:2]) < 0.3
    assert are_near(pose, turned(here))


@pytest.mark.parametrize("place", [Pose(4.0, 1.3, math.pi / 2.0), Pose(4.5, 1.0, 0.0)], ids=str)
def test_a_place_where_other_things_would_be_heard_is_no_twin_for_long(place: Pose) -> None:
    twins = EquivalentPlaces(floor(HALL))
    drive(twins, drive(twins, Pose(1.0, 1.3, 0.0), AHEAD, 0.2), AHEAD, 4.0, place)
    assert twins.poses == []
