"""How soon a robot is driven whose network is not there when it starts, and how soon from afar when it comes."""

from pathlib import Path

import pytest

from tests.functional.robot.test_no_network import AWAY, HOME, NAME, found_anew, sites
from tests.support.process_robot import FULL_TILT
from tests.support.remote_robot import RemoteRobot
from tests.support.sites import Sites
from tests.support.waiting import wait
from tests.timing.stalled import by_the_wall

__all__ = ["sites"]

MODES = ("lan", "fixed")


@pytest.mark.parametrize("mode", MODES)
def test_driven_from_its_own_host_without_a_network(sites: Sites, mode: str, tmp_path: Path) -> None:
    network = tmp_path / "network.toml"
    network.write_text(f'[network]\nmode = "{mode}"\n')
    robot = RemoteRobot(tmp_path, NAME, sites, (HOME, network), (HOME, network))
    try:
        with by_the_wall():
            took = robot.drive(10.0)
    finally:
        robot.close()
    print(f"{mode}: drove {took:.1f} s after its services were started, without a network")


def test_driven_from_afar_when_the_network_came_later(sites: Sites, tmp_path: Path) -> None:
    here, afar = tmp_path / "here.toml", tmp_path / "afar.toml"
    here.write_text('[network]\nmode = "fixed"\n')
    afar.write_text(f'[network]\nmode = "fixed"\nconnect = ["{sites.address(HOME)}"]\n')
    robot = RemoteRobot(tmp_path, NAME, sites, (HOME, here), (AWAY, afar))
    try:
        robot.tilt(FULL_TILT)
        began_us = robot.simulator.now()
        robot.run(2.0)
        sites.plug(HOME)
        with by_the_wall():
            settled = wait(lambda: found_anew(robot, "door"), 20.0)
        robot.run(2.0)
        assert robot.simulator.record(began_us).driven_ms == 0, "who starts again waits for a level hand"
        with by_the_wall():
            took = robot.drive(10.0)
    finally:
        robot.close()
    print(
        f"{settled:.1f} s after the cable was plugged in its door is back; drove {took:.1f} s after it and a level hand"
    )
