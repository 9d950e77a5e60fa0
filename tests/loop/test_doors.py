"""A door as wide as a route asks for is passed: a part of what tests/campaign/test_doors.py does."""

import pytest

from giraff_core.robot import PASSAGE
from tests.loop.doors import pass_door


@pytest.mark.parametrize("name", ["ultrasonic", "scanner"])
def test_a_door_of_the_promised_width_is_passed(name: str) -> None:
    drive = pass_door(name, PASSAGE, seed=17, distance=2.0)
    assert drive.is_clean, drive
