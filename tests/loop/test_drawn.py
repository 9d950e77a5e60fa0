"""One drawn robot of each file, of those that tests/campaign/test_drawn.py drives."""

import pytest

from tests.loop.drawn import require_sound
from tests.support.robot_files import ROBOTS


@pytest.mark.parametrize("name", ROBOTS)
def test_a_drawn_robot_does_what_it_is_asked_and_knows_where_it_is(name: str) -> None:
    require_sound(name, 1)
