"""docker-compose up on laptop, robot and desk: how soon they find each other, and survive each other. In this order."""

import re
import time
from collections.abc import Callable, Iterator
from typing import NamedTuple

import pytest

from tests.hosts.lab import NUMBERS, Lab, Listener
from tests.support.waiting import wait

Figure = Callable[[str, float, float, str], None]

pytestmark = pytest.mark.timeout(600)

BASE_IMAGE_MB = 130.0  # python:3.11-slim-bookworm, unpacked; the stand-in is smaller
MB = 1e6


@pytest.fixture(scope="module")
def desk(lab: Lab) -> Iterator[Listener]:
    """Hears odometry on the desk, from before anything is up."""
    with lab.listen("desk", "odom") as listener:
        yield listener


class Up(NamedTuple):
    """`docker-compose up` on the three hosts at once. s after the last of them returned."""

    healthy: float
    heard: float
    """Odometry, on the desk."""


@pytest.fixture(scope="module")
def up(lab: Lab, desk: Listener) -> Up:
    last = max(lab.on_each(NUMBERS, lab.up).values())
    healthy = lab.wait_until_healthy(*NUMBERS) - last
    wait(lambda: bool(desk.heard()), 30.0, what="odometry on the desk")
    return Up(healthy, desk.heard()[0].at - last)


@pytest.fixture(scope="module")
def _released(lab: Lab, up: Up) -> None:  # noqa: ARG001  only what is up can be asked
    """The emergency stop is reset, from the laptop."""
    lab.reset_emergency_stop()


@pytest.fixture(autouse=True)
def _mended(lab: Lab, _released: None) -> Iterator[None]:
    yield
    lab.mend()


def drive(lab: Lab) -> int:
    """Drive forward at full speed, and keep the joystick tilted. The simulated us."""
    lab.hardware.drive()
    time.sleep(1.0)
    assert lab.hardware.drives()
    return lab.hardware.simulator.now()


def test_all_are_up_at_once(up: Up, figure: Figure) -> None:
    figure("docker-compose up on three hosts -> first odometry on the desk", up.heard, 5.0, "s")
    figure("docker-compose up on three hosts -> all containers healthy", up.healthy, 5.0, "s")


def test_a_tilt_on_the_laptop_turns_the_wheels(lab: Lab, figure: Figure) -> None:
    figure("level hand, then a tilt -> wheels turn", lab.hardware.drive(), 5.0, "s")


@pytest.mark.parametrize("seconds", [1.0, 5.0, 30.0])
def test_a_cut_cable_stops_the_robot(lab: Lab, seconds: float, figure: Figure) -> None:
    boards = lab.hardware
    with lab.listen("laptop", "odom") as laptop:
        wait(lambda: bool(laptop.heard()), 10.0, what="odometry on the laptop")
        cut_us = drive(lab)
        lab.switch.cut(lab.machines["laptop"])
        time.sleep(seconds)
        stopped_after = boards.last_driven(cut_us)
        joined_us = boards.simulator.now()
        lab.switch.join(lab.machines["laptop"])
        flows = laptop.flows_after(time.monotonic(), 20.0)
    assert stopped_after is not None
    figure(f"laptop's cable cut while driving ({seconds:g} s) -> PWM 0, board's record", stopped_after, 0.45, "s")
    figure(f"cable back after {seconds:g} s -> samples flow", flows, 2.0, "s")
    if seconds > 1.0:  # a command that was stale for so long: only a level hand arms again, and this one is tilted
        time.sleep(3.0)
        assert boards.last_driven(joined_us) is None
    boards.drive()


def test_a_bad_link_still_drives(lab: Lab, figure: Figure) -> None:
    lab.switch.lose(lab.machines["laptop"], 2)
    figure("2 % of the laptop's packets lost each way -> wheels turn", lab.hardware.drive(), 5.0, "s")


def test_boards_are_replugged(lab: Lab, desk: Listener, figure: Figure) -> None:
    before = {one.name: one.started_at for one in lab.containers("robot")}
    lab.hardware.unplug("base", "ranger")
    time.sleep(3.0)
    lab.hardware.plug("base", "ranger")
    plugged = time.monotonic()
    figure("boards unplugged for 3 s and plugged in -> odometry on the desk", desk.flows_after(plugged, 20.0), 2.0, "s")
    assert {one.name: one.started_at for one in lab.containers("robot")} == before, "a container was restarted"
    lab.wait_until_healthy("robot")
    lab.hardware.drive()


def test_a_service_starts_soon(lab: Lab, desk: Listener, figure: Figure) -> None:
    lab.compose("robot", "stop", "odometry")
    stopped = time.monotonic()
    lab.compose("robot", "start", "odometry")
    wait(lambda: bool(desk.heard(stopped)), 20.0, what="odometry on the desk")
    started = next(one.started for one in lab.containers("robot") if one.service == "odometry")
    figure("a service's container started -> first sample", desk.heard(stopped)[0].at - started, 2.0, "s")


def test_a_service_needs_little(lab: Lab, figure: Figure) -> None:
    for host in ("robot", "laptop"):
        lines = lab.machines[host].docker("stats", "--no-stream", "--format", "{{.Name}} {{.MemUsage}}").splitlines()
        for name, amount in (line.split(maxsplit=1) for line in lines):
            used = re.match(r"([\d.]+)MiB", amount)
            assert used, amount
            if "watch" not in name:  # a screen, not a service
                figure(f"memory of {name}", float(used[1]) * 2**20 / MB, 40.0, "MB")
    size = float(lab.machines["robot"].docker("image", "inspect", "--format", "{{.Size}}", "giraff:robot")) / MB
    layers = lab.machines["robot"].docker("history", "--human=false", "--format", "{{.Size}}", "giraff:robot").split()
    ours = size - float(layers[-1]) / MB
    figure("the robot's image, with this stand-in for its base", size, 200.0, "MB")
    figure("the robot's image, without its base", ours, 200.0 - BASE_IMAGE_MB, "MB")


def test_a_laptop_that_vanishes_holds_up_nobody(lab: Lab, desk: Listener, figure: Figure) -> None:
    boards = lab.hardware
    control = lab.listen("robot", "odom")
    wait(lambda: bool(control.heard()), 10.0, what="odometry on the robot")
    off_us, off = drive(lab), time.monotonic()
    lab.power_off("laptop")
    time.sleep(12.0)  # as long as the links of a dead host linger in close
    until = time.monotonic()
    here, there = control.longest_gap(off, until), desk.longest_gap(off, until)
    control.close()
    stopped_after = boards.last_driven(off_us)
    assert stopped_after is not None
    figure("laptop's power off while driving -> PWM 0, board's record", stopped_after, 0.45, "s")
    figure(f"laptop's power off -> the desk's longest gap beyond the robot's own {here:.2f}", there - here, 0.5, "s")
    lab.power_on("laptop")
    boards.drive()


def test_a_robot_without_power_comes_back_by_itself(lab: Lab, figure: Figure) -> None:
    boards = lab.hardware
    drive(lab)
    off_us = lab.power_off("robot")
    time.sleep(2.0)
    stopped_after = boards.last_driven(off_us)
    assert stopped_after is not None
    figure("robot's power off while driving -> PWM 0, board's record", stopped_after, 0.35, "s")
    on = time.monotonic()
    lab.power_on("robot")
    boards.drive()
    figure("robot's power back -> it drives", time.monotonic() - on, 10.0, "s")
