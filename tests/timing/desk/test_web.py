"""How soon the robot stops when the hand, the page, its browser, its network or its service is gone while it drives.

By the simulator's record of the motors, as the fault table is judged.
"""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Final

import pytest

from tests.support.browser import Browser, Phone, browser
from tests.support.process_robot import ARENA, ProcessRobot, process_robot
from tests.support.web_page import choose, drive, hold_gamepad, plug_in, served, take, tap, unplug
from tests.timing.faults import OPERATORS, ROBOT_SIDE
from tests.timing.stalled import by_the_wall

SPEED: Final = 0.3
"""m/s that the pad asks for at most."""
DRIVEN: Final = 1.0
"""s before the fault."""
AFTER: Final = 1.5
"""s after it in which nothing may be driven any more."""
BUSY: Final = 1.5  # s

Fault = Callable[[ProcessRobot, Browser, Phone], object]
FAULTS: Final[dict[str, Fault]] = {
    "finger up": lambda _robot, _browser, phone: phone.lift(),
    "tab hidden": lambda _robot, browser, _phone: browser.hide(),
    "page reloaded": lambda _robot, _browser, phone: phone.page.reload(wait_until="commit"),
    "page busy": lambda _robot, _browser, phone: phone.be_busy(BUSY),
    "network cut": lambda _robot, _browser, phone: phone.cut(),
    "service killed": lambda robot, _browser, _phone: robot.kill("web"),
    "browser killed": lambda _robot, browser, _phone: browser.kill(),
    "gamepad's switch let go": lambda _robot, _browser, phone: hold_gamepad(phone, 1.0, held=False),
    "gamepad unplugged": lambda _robot, _browser, phone: unplug(phone),
}

MENDED: Final[dict[str, Callable[[Phone], object]]] = {
    "tab hidden": lambda phone: phone.page.bring_to_front(),
    "network cut": lambda phone: phone.cut(off=False),
    "gamepad unplugged": lambda phone: unplug(phone, off=False),
}


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ProcessRobot]:
    with process_robot(tmp_path_factory.mktemp("robot"), ARENA, boards="host") as made:
        made.stop("joystick")
        yield made


@pytest.fixture
def phone_in_hand(robot: ProcessRobot, tmp_path: Path) -> Iterator[tuple[Browser, Phone]]:
    """Its page may drive."""
    with served(robot) as address, browser(tmp_path / "profile") as people:
        phone = people.phone()
        take(phone, address)
        choose(phone, "Pad")
        yield people, phone


@pytest.mark.parametrize("fault", FAULTS)
def test_whatever_is_gone_the_robot_stops_in_time(
    fault: str, robot: ProcessRobot, phone_in_hand: tuple[Browser, Phone]
) -> None:
    people, phone = phone_in_hand
    by: Final = "Gamepad" if fault.startswith("gamepad") else "Pad"
    if by == "Gamepad":
        plug_in(phone)
        choose(phone, by)
    with by_the_wall():
        drive(robot, phone, DRIVEN, by)
        assert robot.simulator.state().speed == pytest.approx(SPEED, abs=0.05)
        begun_us = robot.simulator.now()
        FAULTS[fault](robot, people, phone)
        robot.run(AFTER)
        last_us = robot.simulator.record(begun_us).last_driven_us
        assert last_us is not None, "it had stopped before"
        took = (last_us - begun_us) * 1e-6
        print(f"{fault}: PWM 0 after {took:.3f} s")
        assert took <= OPERATORS
    mended_us = robot.simulator.now()
    if mend := MENDED.get(fault):
        mend(phone)
    robot.run(AFTER)
    assert robot.simulator.record(mended_us).driven_ms == 0, "a finger that lay there all the time drives again"


def test_another_fingers_stop_is_in_force_at_once(robot: ProcessRobot, phone_in_hand: tuple[Browser, Phone]) -> None:
    _, phone = phone_in_hand
    with by_the_wall():
        drive(robot, phone, DRIVEN)
        begun_us = robot.simulator.now()
        tap(phone, "STOP")
        robot.run(AFTER)
        last_us = robot.simulator.record(begun_us).last_driven_us
        assert last_us is not None, "it had stopped before"
        took = (last_us - begun_us) * 1e-6
        print(f"STOP by another finger: PWM 0 after {took:.3f} s")
        assert took <= ROBOT_SIDE
    phone.wait(lambda: "STOPPED, confirmed" in phone.told(), "a stop that is shown as confirmed")
    phone.lift()
    assert robot.giraff("estop", "reset") == 0
