"""The page of giraff_web, as whoever holds the device uses it."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final, Literal

from tests.support.browser import Device, Phone
from tests.support.process_robot import PATIENCE, ProcessRobot

Input = Literal["Tilt", "Pad", "Keys", "Gamepad"]
TILT: Final = "#tilt"
PAD: Final = "#pad"
"""Where the finger lies that holds."""
_LEVEL: Final = 20
"""Pictures of a level phone, before a finger and under it: the service finds its zero in 0.2 s of readings."""
_FULL: Final = 0.4
"""Of the pad's smaller side: so far from where it was put, a finger asks for full speed."""
_GAMEPAD: Final = """() => {
  const buttons = Array.from({ length: 17 }, () => ({ pressed: false, value: 0 }));
  window.gamepad = { index: 0, id: "Test pad", mapping: "standard", connected: true, buttons, axes: [0, 0, 0, 0] };
  window.isPlugged = true;
  navigator.getGamepads = () => {
    gamepad.axes[2] = 0.01 * Math.random();
    return [isPlugged ? gamepad : null];
  };
}"""
"""One gamepad in a hand, whose other stick trembles."""


@contextmanager
def served(robot: ProcessRobot) -> Iterator[str]:
    """The service beside a robot, for browsers of this host, until the end of the block. An address that may drive."""
    robot.environment |= {"GIRAFF_WEB_PORT": "0", "GIRAFF_WEB_ADDRESS": "127.0.0.1"}
    robot.start("web")
    robot.wait("an address", lambda: _addresses(robot), PATIENCE)
    try:
        yield _addresses(robot)[-1]
    finally:
        robot.stop("web")  # nothing, where a test has killed it


def _addresses(robot: ProcessRobot) -> list[str]:
    """That the service's log has told since it was started, oldest first."""
    return [word for line in robot.messages("web") for word in line.split() if word.startswith("https://")]


def open_page(device: Device, address: str) -> None:
    """And wait until it shows the robot."""
    device.page.goto(address)
    device.page.locator("body[data-link=open]").wait_for()


def take(device: Device, address: str) -> None:
    """The same, with an address that lets it drive."""
    open_page(device, address)
    device.page.locator("body[data-link=open][data-may=drive]").wait_for()


def tap(device: Device, name: str, role: Literal["button", "radio"] = "button") -> None:
    """As `STOP`."""
    device.tap(device.page.get_by_role(role, name=name, exact=True))


def choose(device: Device, what: Input) -> None:
    """What is to drive."""
    tap(device, what, "radio")


def is_held(device: Device) -> bool:
    """Whether the page counts a finger or a key."""
    return device.page.locator(".field.held").count() > 0


def take_hold(phone: Phone, field: str) -> None:
    """Put a finger down under a level phone, until the page counts it.

    A busy page may come to a touch when it is too old to count. The finger is then lifted and put down again.
    """

    def counts() -> bool:
        phone.frames(_LEVEL)
        phone.touch(field)
        phone.frames(_LEVEL)
        if is_held(phone):
            return True
        print(phone.told())
        phone.lift()
        return False

    phone.wait(counts, "a finger that counts")


def is_armed(device: Device) -> bool:
    """Whether the page says that the robot is."""
    return device.page.locator("#armed").inner_text() == "Armed."


def slide(phone: Phone, forward: float, left: float = 0.0) -> None:
    """Of a finger on the pad's middle: shares of what the pad asks for at most."""
    box = phone.page.locator(PAD).bounding_box()
    assert box is not None
    side = _FULL * min(box["width"], box["height"])
    phone.slide(PAD, 0.5 - left * side / box["width"], 0.5 - forward * side / box["height"])


def plug_in(device: Device) -> None:
    """Connect a gamepad that nobody touches, in the place of what the browser tells of real ones."""
    device.page.evaluate(_GAMEPAD)
    device.page.locator("#mode-gamepad:visible").wait_for()


def hold_gamepad(device: Device, forward: float = 0.0, *, held: bool = True) -> None:
    """Press or let go of its right shoulder button, and push its left stick."""
    device.page.evaluate("([held, y]) => { gamepad.buttons[5].pressed = held; gamepad.axes[1] = y; }", [held, -forward])
    device.frames(2)


def unplug(device: Device, *, off: bool = True) -> None:
    """Take the gamepad away as it is held, or bring it back so."""
    device.page.evaluate("(off) => { window.isPlugged = !off; }", off)


def drive(robot: ProcessRobot, phone: Phone, seconds: float, by: Literal["Pad", "Gamepad"] = "Pad") -> None:
    """Forward for so long, as fast as that asks for, with a finger or a gamepad's switch that stays down.

    Where a machine that stood still has stopped it meanwhile, all over again, as a person would.
    """

    def has_driven() -> bool:
        if by == "Pad":
            take_hold(phone, PAD)
            slide(phone, 1.0)
        else:
            plug_in(phone)
            hold_gamepad(phone)
            phone.frames(_LEVEL)
            hold_gamepad(phone, 1.0)
        until = robot.simulator.now() + (seconds + 0.5) * 1e6
        phone.wait(lambda: robot.simulator.now() >= until or not is_held(phone), "driving")
        if is_held(phone) and robot.drives():
            return True
        print(phone.told())
        phone.lift()
        return False

    phone.wait(has_driven, "driving")
