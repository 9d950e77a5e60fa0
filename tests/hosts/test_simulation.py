"""A whole robot without hardware, docker-compose up on one host."""

import re

import pytest

from tests.hosts.lab import PATIENCE, Lab
from tests.support.waiting import wait

pytestmark = pytest.mark.timeout(600)


def test_a_whole_robot_without_hardware(lab: Lab) -> None:
    """On the desk, whose name it then has."""
    gone = re.compile(r"path +(?!0\.00)[\d.]+ m")
    with lab.simulation("desk"):
        with lab.listen("laptop", "odom", robot="sim-desk") as watched:
            lab.up("desk")
            lab.wait_until_healthy("desk")
            wait(lambda: bool(watched.heard()), PATIENCE, what="its odometry on the laptop")
        wait(lambda: gone.search(lab.compose("desk", "logs", "sim")), PATIENCE, what="a way it went", every=1.0)
