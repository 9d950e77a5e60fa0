"""docs/deploy.md typed on robot, laptop and desk: they find each other, and survive each other. In this order.

Whether is asked here; how fast, in tests/timing/hosts.
"""

import os
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Final

import pytest

from giraff_mcap.reading import Recording
from tests.hosts.deploy_page import EDIT, ON_EACH, OTHERWISE, SECTIONS, SHOWS, lines
from tests.hosts.lab import PATIENCE, Lab, Listener, address
from tests.hosts.machine import BIN, LabError
from tests.support.terminals import Screen, screen
from tests.support.waiting import wait
from tests.unit.node.ports import FakePort

pytestmark = [pytest.mark.timeout(600), pytest.mark.usefixtures("up")]

STOPS_WITHIN: Final = 0.45  # s, docs/safety.md
MACHINE_STANDS: Final = 2.0
"""s that are allowed beyond it. The simulated boards go by the wall clock while the processes that serve them, and the
very command that cuts a cable, may wait for a processor: what stops the robot late here need not be the robot."""
MANY: Final = 50
"""Samples: a second's."""
REPEAT: Final = 1.0 / 30.0  # s, as most keyboards repeat a key that is held
_END_OF_A_WHOLE_ONE: Final = b"\x89MCAP0\r\n"


@pytest.fixture(scope="module")
def desk(lab: Lab) -> Iterator[Listener]:
    """Hears odometry on the desk, and is no container."""
    with lab.listen("desk", "odom") as listener:
        yield listener


def stops(lab: Lab, since_us: int) -> None:
    """By the board's own record it stopped soon after that moment, and has stood since."""
    lab.hardware.run(STOPS_WITHIN + MACHINE_STANDS)
    assert (lab.hardware.last_driven(since_us) or 0.0) <= STOPS_WITHIN + MACHINE_STANDS


def many(listener: Listener, since: float) -> None:
    wait(lambda: len(listener.heard(since)) >= MANY, PATIENCE, what="samples")


def test_every_line_of_the_page_is_accounted_for() -> None:
    every = [line for title in SECTIONS.values() for line in lines(title)]
    assert {*OTHERWISE, *SHOWS, EDIT} <= set(every)
    assert any("git clone" in line for line in lines(ON_EACH))


def test_the_desk_hears_the_robot(desk: Listener) -> None:
    many(desk, 0.0)


def test_the_desk_hears_the_arduino(lab: Lab, arduino: FakePort) -> None:
    with lab.listen("desk", "serial/weather") as listener:

        def heard() -> bool:
            arduino.say("23.5 °C\r\n".encode())
            return bool(listener.heard())

        wait(heard, PATIENCE, what="a line on the desk", every=0.5)
        assert listener.heard()[0].sample["text"] == "23.5 °C"


PAGE = """
import ssl, sys, urllib.request
def get(path, context):
    return urllib.request.urlopen(f"https://{sys.argv[1]}:8443{path}", context=context, timeout=60).read().decode()
trusted = ssl.create_default_context(cadata=get("/ca.crt", ssl._create_unverified_context()))
print(get("/", trusted))
"""
"""Trusts the certificate as a phone does that has installed it."""


def test_the_desk_has_the_robots_page(lab: Lab) -> None:
    command = [sys.executable, "-c", PAGE, address("robot")]
    with lab.machines["desk"].start(command, stdout=subprocess.PIPE, text=True) as asking:
        told, _ = asking.communicate(timeout=PATIENCE)
    assert "<title>" in told


def test_a_tilt_on_the_laptop_turns_the_wheels_until_its_cable_is_cut(lab: Lab, desk: Listener) -> None:
    boards = lab.hardware
    with lab.listen("robot", "cmd_vel/joystick") as robot, lab.listen("laptop", "odom") as laptop:
        many(laptop, 0.0)  # a session that is opened during a cut knows no address of its host, and nobody dials it
        boards.drive()
        lab.switch.cut(lab.machines["laptop"])
        cut_us, cut = boards.simulator.now(), time.monotonic()
        stops(lab, cut_us)
        many(desk, cut)
        joined_us, joined = boards.simulator.now(), time.monotonic()
        lab.switch.join(lab.machines["laptop"])
        # Both ways are open again, and the hand is tilted as it was: only a level one arms.
        many(robot, joined)
        laptop.flows_after(joined, PATIENCE)
        boards.run(1.0)
        assert boards.last_driven(joined_us) is None
    boards.drive()


def test_boards_are_replugged(lab: Lab, desk: Listener) -> None:
    before = {one.name: one.started_at for one in lab.containers("robot")}
    lab.hardware.unplug("base", "ranger")
    lab.hardware.run(2.0)
    lab.hardware.plug("base", "ranger")
    desk.flows_after(time.monotonic(), PATIENCE)
    assert {one.name: one.started_at for one in lab.containers("robot")} == before, "a container was restarted"
    lab.wait_until_healthy("robot")
    lab.hardware.drive()


def test_an_emergency_stop_from_the_desk_outlives_the_power_and_needs_no_network(lab: Lab, tmp_path: Path) -> None:
    """And what was is recorded; without a network the robot's own keyboard drives it."""
    boards = lab.hardware
    before = recordings(lab, tmp_path / "before")
    boards.drive()
    lab.compose("desk", "run", "--rm", "giraff", "estop", "engage", "--reason", "a cat")
    stops(lab, boards.simulator.now())
    recorded_is_the_emergency_stop(lab, tmp_path, before)

    lab.power_off("robot")
    on_us = boards.simulator.now()
    lab.power_on("robot", cable=False)
    try:
        with keyboard(lab) as shown:
            shown.wait_for("ENGAGED; r releases it. By ", PATIENCE)
            for _ in range(2):
                hold(lab, shown)
            assert boards.last_driven(on_us) is None
            lab.reset_emergency_stop("robot")
            wait(lambda: hold(lab, shown), PATIENCE, what="wheels turned by the keyboard")
            shown.type(b"\x03")
            assert shown.ended(PATIENCE) == 0
        stops(lab, boards.simulator.now())
        lab.wait_until_healthy("robot")
    finally:
        lab.power_off("robot")
        lab.power_on("robot")
    boards.drive()  # by the laptop again: its services came back by themselves, and met


def recordings(lab: Lab, place: Path) -> set[str]:
    """Names of the flight recorder's files, of which `place` gets a copy."""
    [recorder] = [one.name for one in lab.containers("robot") if one.service == "recorder"]
    place.mkdir(exist_ok=True)
    with suppress(LabError):  # there is no folder before the first file
        lab.machines["robot"].docker("cp", f"{recorder}:/var/lib/giraff/incidents", str(place))
    return {file.name for file in place.glob("incidents/*.mcap")}


def recorded_is_the_emergency_stop(lab: Lab, place: Path, before: set[str]) -> None:
    files: list[Path] = []

    def written() -> bool:
        new = recordings(lab, place) - before
        files[:] = [place / "incidents" / name for name in new if name.endswith("-estop.mcap")]
        return bool(files) and files[0].read_bytes().endswith(_END_OF_A_WHOLE_ONE)

    def told() -> str:
        return f"a recording of the emergency stop\n{lab.compose('robot', 'logs', 'recorder')}"

    wait(written, PATIENCE, what=told, every=0.5)
    recording = Recording(files[0])
    assert ": a cat" in recording.about["incident"]
    assert {"odom", "wheels", "estop", "guard"} <= set(recording.keys)


@contextmanager
def keyboard(lab: Lab) -> Iterator[Screen]:
    """The robot's own."""
    environment = os.environ | {"PATH": BIN, "DOCKER_HOST": lab.machines["robot"].socket}
    typed = f"cd {lab.clone('robot')} && exec docker-compose run --rm keyboard"
    with screen(["/bin/sh", "-c", typed], lab.directory / "keyboard.log", environment) as shown:
        yield shown


def hold(lab: Lab, shown: Screen) -> bool:
    """Ask for the robot, let go, which arms, and hold the key for ahead; whether the wheels turn."""
    shown.type(b"c")
    lab.hardware.simulator.place(0.0, 0.0)
    lab.hardware.run(1.0)
    until_us = lab.hardware.simulator.now() + 1_500_000
    while lab.hardware.simulator.now() < until_us:
        shown.type(b"w")
        shown.read()
        if lab.hardware.drives():
            return True
        time.sleep(REPEAT)
    return False
