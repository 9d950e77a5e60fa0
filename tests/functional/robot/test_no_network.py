"""A robot whose network is not there when it starts: driven on its own host, and from afar when the network comes."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.support.process_robot import FULL_TILT, PATIENCE
from tests.support.remote_robot import RemoteRobot
from tests.support.sites import Sites
from tests.support.waiting import wait

HOME, AWAY = "home", "away"
NAME = "sim-late"


@pytest.fixture
def sites() -> Iterator[Sites]:
    with Sites(HOME, AWAY, routed=True) as made:
        made.pull(HOME)
        made.await_link(HOME, "DOWN")
        yield made


def test_driven_from_its_own_host_without_a_network(sites: Sites, tmp_path: Path) -> None:
    network = tmp_path / "network.toml"
    network.write_text('[network]\nmode = "lan"\n')
    robot = RemoteRobot(tmp_path, NAME, sites, (HOME, network), (HOME, network))
    try:
        took = robot.drive()
    finally:
        robot.close()
    print(f"drove {took:.1f} s after its services were started, without a network")


def test_driven_from_afar_when_the_network_came_later(sites: Sites, tmp_path: Path) -> None:
    here, afar = tmp_path / "here.toml", tmp_path / "afar.toml"
    here.write_text('[network]\nmode = "fixed"\n')
    afar.write_text(f'[network]\nmode = "fixed"\nconnect = ["{sites.address(HOME)}"]\n')
    robot = RemoteRobot(tmp_path, NAME, sites, (HOME, here), (AWAY, afar))
    try:
        robot.tilt(FULL_TILT)  # from before they meet: a hand that is level meanwhile may arm as soon as it is heard
        began_us = robot.simulator.now()
        robot.run(1.0)
        sites.plug(HOME)
        settled = wait(lambda: found_anew(robot, "door"), PATIENCE)
        robot.run(2.0)
        again = [service for service in ("base", "guard", "ranger", "odometry") if found_anew(robot, service)]
        assert again == [], "a network that comes is no news to who stops the robot"
        assert robot.simulator.record(began_us).driven_ms == 0, "who starts again waits for a level hand"
        took = robot.drive()
    finally:
        robot.close()
    print(
        f"{settled:.1f} s after the cable was plugged in its door is back; drove {took:.1f} s after it and a level hand"
    )


def found_anew(robot: RemoteRobot, service: str) -> bool:
    _, again, since = robot.says(service).partition("starting again")
    return bool(again) and "pid" in since
