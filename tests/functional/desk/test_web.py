"""The page of `giraff run --web` in a real browser: a phone drives a metre by tilt, and a laptop looks on.

By the world's truth. What a machine that stands still has ended is done again, as a person would.
"""

from __future__ import annotations

import math
import os
import signal
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from giraff_schemas.messages import TruePose
from giraff_schemas.topics import ESTOP, TRUE_POSE
from tests.support.browser import Browser, Phone, browser
from tests.support.observer import Observer
from tests.support.process_robot import PATIENCE
from tests.support.runs import SMALL_ROOM, Command, command_in, line_of
from tests.support.web_page import TILT, choose, is_armed, is_held, open_page, take, take_hold, tap

pytestmark = pytest.mark.timeout(240)

FORWARD = 25.0
"""Degrees from the attitude at the touch."""


@pytest.fixture
def command(tmp_path: Path) -> Iterator[Command]:
    (tmp_path / "world.toml").write_text(SMALL_ROOM)
    with command_in(tmp_path) as made:
        made.environment["GIRAFF_ROBOT_BATTERY_VOLTS_PER_COUNT"] = "0.03"
        yield made


@pytest.fixture
def observer(command: Command) -> Iterator[Observer]:
    made = Observer(command.environment)
    for topic in (TRUE_POSE, ESTOP):
        made.follow(topic)
    yield made
    made.close()


@pytest.fixture
def people(tmp_path: Path) -> Iterator[Browser]:
    with browser(tmp_path / "profile") as started:
        yield started


def truth(observer: Observer, phone: Phone) -> TruePose:
    """Where the robot is, by the world, in a word that is said from now on."""
    before = observer.newest(TRUE_POSE)
    phone.wait(lambda: observer.newest(TRUE_POSE) is not before, "the truth")
    newest = observer.newest(TRUE_POSE)
    assert newest is not None
    return newest


def distance(one: TruePose, other: TruePose) -> float:
    return math.dist((one.x, one.y), (other.x, other.y))


def drive_by_tilt(phone: Phone, observer: Observer, metres: float) -> None:
    """A finger down on a level phone, and the phone tilted; again for the rest of it where something has ended that."""
    began = truth(observer, phone)

    def has_come() -> bool:
        newest = observer.newest(TRUE_POSE)
        return newest is not None and distance(began, newest) >= metres

    def comes() -> bool:
        phone.tilt()
        take_hold(phone, TILT)
        phone.wait(lambda: is_armed(phone) or not is_held(phone), "an armed robot")
        phone.tilt(forward=FORWARD)
        phone.wait(lambda: has_come() or not (is_held(phone) and is_armed(phone)), f"{metres:g} m")
        if not has_come():
            print(phone.told())
            phone.lift()
        return has_come()

    phone.wait(comes, f"{metres:g} m", 2.0 * PATIENCE)


def is_at_rest(phone: Phone, observer: Observer) -> bool:
    one = truth(observer, phone)
    phone.hold(0.3)
    return distance(one, truth(observer, phone)) < 0.002


def test_a_phone_drives_a_metre_by_tilt_and_a_laptop_stops_it(
    command: Command, observer: Observer, people: Browser
) -> None:
    with command.start("--web", "--hand", "none", "--boards", "host", "--world", "world.toml", local=False) as process:
        address = line_of(process, "page: ").removeprefix("page: ").strip()
        phone = people.phone()
        take(phone, address)
        choose(phone, "Tilt")
        kept = os.environ.get("GIRAFF_PICTURES")
        looks_on = people.laptop() if kept else None
        if looks_on is not None:
            open_page(looks_on, address.partition("#")[0])
        began = truth(observer, phone)
        drive_by_tilt(phone, observer, 1.0)
        if kept and looks_on is not None:
            (Path(kept) / "web-laptop.png").write_bytes(looks_on.picture())
            (Path(kept) / "web-phone.png").write_bytes(phone.picture())  # for which a page stands still
        phone.lift()
        phone.wait(lambda: is_at_rest(phone, observer), "a robot at rest")
        assert distance(began, truth(observer, phone)) < 1.5

        laptop = people.laptop()
        laptop.page.goto(address)
        laptop.wait(lambda: "was used" in laptop.told() and "Android phone" in laptop.told(), "whose the token was")
        assert phone.violations() == []
        assert laptop.violations() == []
        tap(laptop, "STOP")
        phone.wait(lambda: (estop := observer.newest(ESTOP)) is not None and estop.engaged, "a stop that base confirms")
        laptop.wait(lambda: "STOPPED, confirmed" in laptop.told(), "a stop that is shown as confirmed")
        for device in (phone, laptop):
            assert device.hosts == {urlsplit(address).netloc}
            assert [each for each in device.complaints if "403" not in each] == []
        process.send_signal(signal.SIGTERM)
        _, complaint = process.communicate(timeout=PATIENCE)
        assert not complaint, complaint
        assert process.returncode == 0
    assert command.leaves_nothing()
