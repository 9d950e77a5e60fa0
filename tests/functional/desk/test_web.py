"""The page of `giraff run --web` in a real browser: each input drives, a phone a metre by tilt, and a laptop stops it.
The phone sees by the robot's camera.

By the world's truth. What a machine that stands still has ended is done again, as a person would.
"""

import math
import os
import re
import signal
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Final
from urllib.parse import urlsplit

import pytest
from playwright.sync_api import TimeoutError as PlaywrightTimeoutError

from giraff_core.estop.request import BY_WORD
from giraff_schemas.messages import TruePose
from giraff_schemas.topics import ESTOP, TRUE_POSE
from tests.support.browser import Browser, Device, Phone, browser
from tests.support.observer import Observer
from tests.support.process_robot import PATIENCE
from tests.support.runs import SMALL_ROOM, Command, command_in, line_of
from tests.support.web_page import (
    PAD,
    TILT,
    Input,
    choose,
    hold_gamepad,
    is_armed,
    is_held,
    open_page,
    plug_in,
    slide,
    take,
    take_hold,
    tap,
    unplug,
)
from tests.unit.cli.typed import typed

pytestmark = pytest.mark.timeout(240)

FORWARD = 25.0
"""Degrees from the attitude at the touch."""
KEY = "ArrowUp"
ARMS = 60
"""Pictures without a key, in which a page arms the robot that it drives: base wants 0.2 s of neutral moments."""
IS_WHOLE = """(button) => {
  const { left, right, top, bottom } = button.getBoundingClientRect();
  const seen = (x, y) => button.contains(document.elementFromPoint(x, y));
  return [left + 12, right - 12].every((x) => [top + 4, bottom - 4].every((y) => seen(x, y)));
}"""
"""Nothing lies over a button's corners, and they are on the screen."""
SCREENS: Final = ((360, 640), (412, 839), (640, 360), (839, 412), (1280, 800))
"""CSS pixels of phones upright and on their side, and of a laptop."""
COVERED = """() => {
  const seen = [...document.querySelectorAll("button, summary, .field, #place")];
  const parts = seen.filter((each) => each.checkVisibility({ visibilityProperty: true }));
  const box = (part) => part.getBoundingClientRect();
  const apart = (a, b) => a.right <= b.left || b.right <= a.left || a.bottom <= b.top || b.bottom <= a.top;
  const meet = (part, other) => part !== other && !apart(box(part), box(other));
  const pairs = parts.flatMap((part) => parts.filter((other) => meet(part, other)).map((other) => [part.id, other.id]));
  const plan = box(document.getElementById("floor"));
  const [x, y] = [(plan.left + plan.right) / 2, (plan.top + plan.bottom) / 2];
  const whole = document.body.classList.contains("whole");
  if (!whole && document.elementFromPoint(x, y).id !== "floor") pairs.push(["floor"]);
  return pairs;
}"""
"""Controls that lie over one another, and a plan whose robot something hides."""
SHARE = """() => {
  const { width, height } = document.getElementById("picture").getBoundingClientRect();
  return (width * height) / (innerWidth * innerHeight);
}"""
"""Share of the screen that the picture's box has; upright, the picture fills it."""
TURNED = 0.05
"""m by which the wheels have turned."""


@pytest.fixture
def command(
    tmp_path: Path, tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch
) -> Iterator[Command]:
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path_factory.mktemp("r")))  # short, as the path of a socket must be
    (tmp_path / "world.toml").write_text(SMALL_ROOM)
    with command_in(tmp_path) as made:
        made.environment["GIRAFF_BASE_DRIVE__BATTERY_VOLTS_PER_COUNT"] = "0.03"
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


def drives(phone: Phone) -> bool:
    """Whether the page says that it holds the lease."""
    return phone.page.locator("#driver").inner_text() == "You drive."


def go_by_tilt(phone: Phone) -> None:
    phone.tilt()
    take_hold(phone, TILT)
    phone.wait(lambda: is_armed(phone) or not is_held(phone), "an armed robot")
    phone.tilt(forward=FORWARD)


def go_by_pad(phone: Phone) -> None:
    take_hold(phone, PAD)
    phone.wait(lambda: is_armed(phone) or not is_held(phone), "an armed robot")
    slide(phone, 1.0)


def go_by_keys(phone: Phone) -> None:
    """The robot is taken with a key, and armed by letting go, as the page says."""
    phone.page.keyboard.down(KEY)
    phone.wait(lambda: drives(phone) or not is_held(phone), "whose robot it is")
    phone.page.keyboard.up(KEY)
    phone.frames(ARMS)
    phone.page.keyboard.down(KEY)


def go_by_gamepad(phone: Phone) -> None:
    plug_in(phone)
    hold_gamepad(phone)
    phone.wait(lambda: is_armed(phone) or not is_held(phone), "an armed robot")
    hold_gamepad(phone, 1.0)


WAYS: Final[dict[Input, tuple[Callable[[Phone], None], Callable[[Phone], object]]]] = {
    "Keys": (go_by_keys, lambda phone: phone.page.keyboard.up(KEY)),
    "Pad": (go_by_pad, Phone.lift),
    "Gamepad": (go_by_gamepad, unplug),
    "Tilt": (go_by_tilt, Phone.lift),
}
"""How each input goes ahead, and how it lets go."""


def drive(phone: Phone, observer: Observer, by: Input, metres: float, tries: int) -> None:
    """Ahead; again for the rest of it where something has ended that. So many tries are a busy machine's."""
    began = truth(observer, phone)
    go, let_go = WAYS[by]

    def has_come() -> bool:
        newest = observer.newest(TRUE_POSE)
        return newest is not None and distance(began, newest) >= metres

    if by == "Gamepad":
        plug_in(phone)  # until then there is nothing to choose
    choose(phone, by)
    for _ in range(tries):
        go(phone)
        phone.wait(lambda: has_come() or not (is_held(phone) and is_armed(phone)), f"{metres:g} m")
        if has_come():
            return
        print(by, phone.told())
        let_go(phone)
    raise AssertionError(f"not {metres:g} m by {by} in {tries} tries")


def each_drives(phone: Phone, observer: Observer, address: str) -> None:
    """A little by each input but tilt. A gamepad is not let go but unplugged."""
    kept = os.environ.get("GIRAFF_PICTURES")
    for by in ("Keys", "Pad", "Gamepad"):
        drive(phone, observer, by, TURNED, 6)
        if kept and by == "Gamepad":
            (Path(kept) / "web-gamepad.png").write_bytes(phone.picture())
        WAYS[by][1](phone)
        phone.wait(lambda: is_at_rest(phone, observer), "a robot at rest")
        if by == "Gamepad":
            assert phone.violations() == []
        take(phone, address)
        phone.wait(lambda: "Not armed." in phone.told(), "a robot that a closed page has left unarmed")


def is_at_rest(phone: Phone, observer: Observer) -> bool:
    one = truth(observer, phone)
    phone.hold(0.3)
    return distance(one, truth(observer, phone)) < 0.002


def asks_whole(phone: Phone) -> None:
    """The question that releases the stop shows both of its buttons whole, below as much text as two long reasons."""
    phone.page.evaluate("document.getElementById('reasons').style.minHeight = '8rem'")
    tap(phone, "Release…")
    phone.frames(2)
    for button in ("Stay stopped", "Release"):
        assert phone.page.get_by_role("button", name=button, exact=True).evaluate(IS_WHOLE), f"{button}: {phone.told()}"
    tap(phone, "Stay stopped")


def ends_pages(phone: Phone, laptop: Device, web: Callable[..., str]) -> None:
    """The phone, which may drive, ends the laptop's page; `giraff web --end` ends the phone's."""
    pages = phone.page.locator("#pages")
    pages.locator("summary").click()
    pages.locator("li").first.wait_for()
    if kept := os.environ.get("GIRAFF_PICTURES"):
        (Path(kept) / "web-pages.png").write_bytes(phone.picture())
    listed = web("--devices")
    assert "Android phone" in listed
    assert listed.rstrip().endswith("watches")
    pages.get_by_role("button", name="End the page of").last.click()
    laptop.wait(lambda: "this page was ended; reload it to watch" in laptop.told(), "the end of a page")
    web("--end", "Android phone")
    phone.wait(lambda: "this page was ended" in phone.told(), "the end of the other")


def picture(phone: Phone, which: str = "#shown") -> str:
    """What the page shows of the camera; empty: nothing that is so. What a busy machine has ended is begun again."""
    if (show := phone.page.get_by_role("button", name="Show picture of the camera")).is_visible():
        phone.tap(show)
        with suppress(PlaywrightTimeoutError):  # until it is taken: a second tap would hide the picture again
            show.wait_for(state="hidden", timeout=5000)
    is_shown = phone.page.locator(which).is_visible()
    return str(phone.page.evaluate("document.getElementById('picture').toDataURL()")) if is_shown else ""


def drive_and_see(phone: Phone, observer: Observer) -> tuple[TruePose, str]:
    """A metre by tilt, with a picture, and none before the tap. Where it began, and with which picture."""
    assert not phone.page.locator("#shown").is_visible()
    phone.wait(lambda: picture(phone), "a picture")
    before = picture(phone)
    began = truth(observer, phone)
    drive(phone, observer, "Tilt", 1.0, 20)
    return began, before


def fill(phone: Phone) -> bool:
    """Make the camera's picture fill the screen. Return whether it does: what is busy may have ended it."""
    if not phone.page.locator("body.whole").count() and picture(phone, "#picture"):
        phone.tap(phone.page.locator("#picture"))
        with suppress(PlaywrightTimeoutError):  # until it does: a second tap would end it
            phone.page.locator("body.whole").wait_for(timeout=5000)
    return phone.page.locator("body.whole").count() > 0


def layout(phone: Phone, whole: bool, found: list[tuple[float, object, object]]) -> bool:
    """Find how the page is laid out. Return False where a busy machine has ended the picture meanwhile."""
    fresh = f"body{'.whole' if whole else ':not(.whole)'} #shown:not(.old) #picture"
    if not (fill(phone) if whole else picture(phone, fresh)):
        return False
    phone.frames(5)
    page = phone.page
    found.append((page.evaluate(SHARE), page.evaluate(COVERED), page.locator("#stop").evaluate(IS_WHOLE)))
    return page.locator(fresh).is_visible()


def fits_screens(phone: Phone) -> None:
    """On each screen the picture has its share, no control covers another, and STOP is whole, also on the whole one."""
    kept = os.environ.get("GIRAFF_PICTURES")
    for size in SCREENS:
        phone.resize(*size)
        for whole, least in ((False, 0.36 if size[0] < size[1] else 0.18), (True, 0.85)):
            found: list[tuple[float, object, object]] = []
            phone.wait(partial(layout, phone, whole, found), "a new picture")
            share, covered, is_whole = found[-1]
            told = f"{size}, {whole}: {phone.told()}"
            assert (share > least, covered, is_whole) == (True, [], True), told
            if kept:
                name = f"web-{size[0]}x{size[1]}{'-whole' * whole}.png"
                (Path(kept) / name).write_bytes(phone.picture())
        if size == SCREENS[0]:
            assert phone.violations() == []
        phone.page.go_back()
        phone.page.locator("body:not(.whole)").wait_for()


def grows_old(phone: Phone, watcher: Device, camera: int) -> None:
    """A picture of a camera's process that stands still is shown as old. Who watches is told of it, and sees none."""
    phone.wait(lambda: picture(phone, "#shown:not(.old)"), "a new picture")
    phone.wait(lambda: fill(phone), "a picture on the whole screen")
    watcher.wait(lambda: re.search(r"camera is on, for .*\bweb@", watcher.told()), "who looks")
    assert "visual odometry (" in watcher.told()
    assert not watcher.page.locator("#look").is_visible()
    assert not watcher.page.locator("#shown").is_visible()
    os.kill(camera, signal.SIGSTOP)
    try:
        phone.page.locator(".whole #shown.old #picture-age").wait_for()
    finally:
        os.kill(camera, signal.SIGCONT)
    phone.page.keyboard.press("Escape")
    phone.page.locator("body:not(.whole)").wait_for()


def read(code: int, told: str, complaint: str) -> str:
    """What a command has told, which went well."""
    assert (code, complaint) == (0, "")
    return told


def test_each_input_drives_a_metre_by_tilt_and_a_laptop_stops_it(
    command: Command,
    observer: Observer,
    people: Browser,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    options = ("--web", "--camera", "--hand", "none", "--boards", "host", "--world", "world.toml")
    with command.start(*options, local=False) as process:
        address = line_of(process, "page: ").removeprefix("page: ").strip()
        phone = people.phone()
        take(phone, address)
        bare = address.partition("#")[0]  # the token is spent, and the phone has its cookie
        each_drives(phone, observer, bare)
        kept = os.environ.get("GIRAFF_PICTURES")
        looks_on = people.laptop() if kept else None
        if looks_on is not None:
            open_page(looks_on, bare)
        began, before = drive_and_see(phone, observer)
        if kept and looks_on is not None:
            (Path(kept) / "web-laptop.png").write_bytes(looks_on.picture())
            (Path(kept) / "web-phone.png").write_bytes(phone.picture())  # for which a page stands still
        phone.lift()
        phone.wait(lambda: is_at_rest(phone, observer), "a robot at rest")
        assert distance(began, truth(observer, phone)) < 1.5
        phone.wait(lambda: picture(phone) not in ("", before), "a picture that moves")
        fits_screens(phone)

        laptop = people.laptop()
        laptop.page.goto(address)
        laptop.wait(lambda: "was used" in laptop.told() and "Android phone" in laptop.told(), "whose the token was")
        grows_old(phone, laptop, command.pid("giraff_node camera"))
        assert phone.violations() == []
        assert laptop.violations() == []
        tap(laptop, "STOP")
        phone.wait(lambda: (estop := observer.newest(ESTOP)) is not None and estop.engaged, "a stop that base confirms")
        laptop.wait(lambda: f"STOPPED, {BY_WORD}" in laptop.told(), "a stop that is shown as confirmed")
        assert laptop.page.locator("#why").inner_text().startswith("STOPPED. "), laptop.told()
        assert laptop.page.locator("[data-clearance=stopped]").count() == 4, laptop.told()
        laptop.page.get_by_role("button", name="STOP", exact=True).hover()
        laptop.page.mouse.down()
        laptop.wait(lambda: "STOPPED, not off: this robot's drive has no" in laptop.told(), "what base says of off")
        laptop.page.mouse.up()
        for size in (SCREENS[2], (390, 844), SCREENS[0]):
            phone.resize(*size)
            asks_whole(phone)
        monkeypatch.setenv("XDG_STATE_HOME", os.environ["XDG_RUNTIME_DIR"])  # no page of another test
        ends_pages(phone, laptop, lambda *asked: read(*typed(monkeypatch, capsys, "web", *asked)))
        for device in (phone, laptop):
            assert device.hosts == {urlsplit(address).netloc}
            assert [each for each in device.complaints if "403" not in each] == []
        process.send_signal(signal.SIGTERM)
        _, complaint = process.communicate(timeout=PATIENCE)
        assert not complaint, complaint
        assert process.returncode == 0
    assert command.leaves_nothing()
