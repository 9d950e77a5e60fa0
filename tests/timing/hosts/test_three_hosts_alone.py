"""The robot's computer started without any network, and driven by its own keyboard."""

import os
import time
from collections.abc import Callable, Iterator
from typing import Final

import pytest

from tests.hosts.lab import NUMBERS, Lab
from tests.hosts.machine import BIN
from tests.support.keyboard_user import FREE, hold, take
from tests.support.terminals import screen

Figure = Callable[[str, float, float, str], None]

pytestmark = pytest.mark.timeout(300)

STARTS_WITHIN: Final = 30.0  # s
STOPS_WITHIN: Final = 0.45
"""s from the last press to PWM zero."""


@pytest.fixture
def alone(lab: Lab) -> Iterator[None]:
    """Its containers are up again after a power cycle, and its cable is gone."""
    lab.down(*NUMBERS)
    lab.write_env("robot")
    lab.load("robot", "laptop")  # docs/deploy.md: the command line, for a robot that may lose its network
    lab.up("robot")
    lab.reset_emergency_stop("robot")
    lab.power_off("robot")
    lab.power_on("robot", cable=False)
    lab.wait_until_healthy("robot")
    yield
    lab.power_off("robot")
    lab.power_on("robot")


@pytest.mark.usefixtures("alone")
def test_a_robot_without_a_network_is_driven_by_its_keyboard(lab: Lab, figure: Figure) -> None:
    environment = os.environ | {"PATH": BIN, "DOCKER_HOST": lab.machines["robot"].socket}
    typed = f"cd {lab.clone('robot')} && exec docker-compose run --rm keyboard"
    with screen(["/bin/sh", "-c", typed], lab.directory / "keyboard.log", environment) as shown:
        shown.wait_for(FREE, STARTS_WITHIN)
        take(shown)
        lab.hardware.simulator.place(0.0, 0.0)
        hold(shown, b"w", 1.5)
        assert lab.hardware.drives()
        let_go_us = lab.hardware.simulator.now()
        time.sleep(1.0)
        stopped_after = lab.hardware.last_driven(let_go_us)
        shown.type(b"\x03")
        assert shown.process.wait(10.0) == 0
    assert stopped_after is not None
    figure("without a network: the key let go -> PWM 0, board's record", stopped_after, STOPS_WITHIN, "s")
