"""The keyboard service, or `giraff drive`, in a terminal of its own, and somebody who types."""

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager

from tests.support.process_robot import PATIENCE, ProcessRobot
from tests.support.terminals import Screen, screen

KEYBOARD = [sys.executable, "-m", "giraff_node", "keyboard"]
DRIVE = [sys.executable, "-m", "giraff_cli", "drive"]
ARMED = "yours, armed"
FREE = "nobody's: press an arrow"
REPEAT = 1.0 / 30.0  # s, as most keyboards repeat a key that is held


@contextmanager
def keyboard(robot: ProcessRobot) -> Iterator[Screen]:
    """Beside a robot that has no other operator."""
    with screen(KEYBOARD, robot.directory / "keyboard.log", robot.environment | {"TERM": "xterm"}) as shown:
        shown.wait_for(FREE, PATIENCE)
        yield shown


@contextmanager
def drive(robot: ProcessRobot) -> Iterator[Screen]:
    """The same, of somebody who has no robot file."""
    network = {name: value for name, value in robot.environment.items() if not name.startswith("GIRAFF_")}
    network |= {name: value for name, value in robot.environment.items() if name.startswith("GIRAFF_NETWORK_")}
    with screen(
        [*DRIVE, "--robot", robot.environment["GIRAFF_ROBOT_NAME"]],
        robot.directory / "drive.log",
        network | {"GIRAFF_CONFIG": "/dev/null", "TERM": "xterm"},
    ) as shown:
        shown.wait_for(FREE, PATIENCE)
        yield shown


def hold(shown: Screen, key: bytes, seconds: float) -> None:
    """Hold a key down."""
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        shown.type(key)
        time.sleep(REPEAT)


def take(shown: Screen, key: bytes = b"c") -> None:
    """Ask for the lease and let go, which arms; again where the robot was not yet heard when the key was pressed.

    `key`: one that drives takes it from who ranks lower, too.
    """
    press_until(shown, key, ARMED)


def press_until(shown: Screen, key: bytes, answer: str) -> None:
    """Press a key until the answer is shown: a busy machine may not have heard of the robot just then."""
    shown.forget()
    deadline = time.monotonic() + PATIENCE
    while answer not in shown.read():
        assert time.monotonic() < deadline, f"{key!r} is not answered: {shown.text[-2000:]}"
        shown.type(key)
        again = time.monotonic() + 1.0
        while answer not in shown.read() and time.monotonic() < again:
            time.sleep(REPEAT)


def drive_by(robot: ProcessRobot, shown: Screen, key: bytes) -> None:
    """Hold a key until the wheels turn; where that does not do, let go, take the robot, and press again."""
    deadline = time.monotonic() + PATIENCE
    while True:
        until = time.monotonic() + 2.0
        while time.monotonic() < until:
            shown.type(key)
            time.sleep(REPEAT)
            if robot.drives():
                return
        assert time.monotonic() < deadline, f"{key!r} does not drive: {shown.text[-2000:]}"
        take(shown)
