"""giraff_localization hears the senses that it goes by, and names the service that should send them."""

from typing import Any
from unittest.mock import MagicMock

import pytest

from giraff_core.robot import RobotConfig
from giraff_localization.service import SILENCE, Localization
from giraff_schemas.topics import RANGE, SCAN
from giraff_schemas.trouble import Trouble
from tests.support.robots import ROBOT
from tests.unit.localization.rooms import CONFIG
from tests.unit.localization.scanned import SCANNED


@pytest.mark.parametrize(
    ("robot", "topic", "silent"),
    [
        (ROBOT, RANGE, {"odom": "giraff_odometry", "range": "giraff_ranger"}),
        (SCANNED, SCAN, {"odom": "giraff_odometry", "scan": "giraff_scan"}),
    ],
    ids=["sonars", "scanner"],
)
def test_it_names_the_service_that_is_silent(robot: RobotConfig, topic: Any, silent: dict[str, str]) -> None:
    io = MagicMock(**{"monotonic.return_value": 0.0})
    service = Localization(io, CONFIG, robot, Trouble("there is no map"))
    assert (topic,) in [call.args for call in io.inbox.call_args_list if call.kwargs == {"wakes": False}]
    service.turn(SILENCE + 0.1)
    said = {call.args[0]: str(call.args[1]) for call in io.set_notice.call_args_list}
    assert list(said) == list(silent)
    assert all(f"check that {silent[name]} runs" in text for name, text in said.items())
