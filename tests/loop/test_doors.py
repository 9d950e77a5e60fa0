"""A door as wide as is promised is passed: a part of what tests/campaign/test_doors.py does."""

import msgspec
import pytest

from giraff_core.senses import LaserScanner, Sense, Ultrasonic
from tests.loop.doors import KINDS, pass_door
from tests.support.robots import BUMPED, FITTED, ROBOT


@pytest.mark.parametrize("name", ["ultrasonic", "scanner"])
def test_a_door_of_the_promised_width_is_passed(name: str) -> None:
    drive = pass_door(name, KINDS[name].needs, seed=17, distance=2.0)
    assert drive.is_clean, drive


def test_a_scanner_decides_what_a_robot_needs_beside_it() -> None:
    blind = msgspec.structs.replace(ROBOT, sensors={})
    for robot, decides in ((FITTED, LaserScanner), (BUMPED, Ultrasonic), (blind, Sense)):
        assert robot.passage_radius == robot.footprint_radius + decides.PASSAGE
