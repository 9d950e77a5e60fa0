"""The keyboard as it really runs: a process in a terminal, somebody who types, and the board's own record."""

from __future__ import annotations

import signal
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from tests.support.process_robot import ProcessRobot, process_robot
from tests.support.terminals import Screen, screen
from tests.timing.stalled import by_the_wall

KEYBOARD = [sys.executable, "-m", "giraff_keyboard"]
REPEAT = 1.0 / 30.0  # s, as most keyboards repeat a key that is held
STOPS_WITHIN = 0.45
"""s from the last press to PWM zero."""


@contextmanager
def keyboard(directory: Path) -> Iterator[tuple[ProcessRobot, Screen]]:
    """A robot whose only operator is a keyboard."""
    with process_robot(directory, boards="host") as robot:
        robot.stop("joystick")
        with screen(KEYBOARD, directory / "keyboard.log", robot.environment) as shown:
            shown.wait_for("nobody drives")
            yield robot, shown


def hold(shown: Screen, key: bytes, seconds: float) -> None:
    """Hold a key down."""
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        shown.type(key)
        time.sleep(REPEAT)


def take(shown: Screen) -> None:
    """Ask for the lease and let go, which arms; again where the robot was not yet heard when the key was pressed."""
    shown.forget()
    deadline = time.monotonic() + 15.0
    while "keyboard drives   armed" not in shown.read():
        assert time.monotonic() < deadline, shown.text[-2000:]
        shown.type(b"c")
        time.sleep(1.0)


def stop_time(robot: ProcessRobot, since_us: int) -> float:
    robot.run(1.0)
    last = robot.simulator.record(since_us).last_driven_us
    return ((last or since_us) - since_us) * 1e-6


def test_it_takes_arms_drives_and_stops_by_the_space_bar(tmp_path: Path) -> None:
    with keyboard(tmp_path) as (robot, shown):
        robot.run(1.0)
        assert "keyboard drives" not in shown.read()  # nobody takes a robot by starting a program
        take(shown)
        with by_the_wall():
            hold(shown, b"w", 1.0)
            assert robot.drives()
            took = stop_time(robot, robot.simulator.now())
            print(f"key let go: PWM 0 after {took:.3f} s")
            assert took <= STOPS_WITHIN

        with by_the_wall():
            hold(shown, b"\x1b[D", 1.0)
            says = robot.simulator.state().base
            assert says is not None
            assert says.left_pwm_counts != 0
        assert says.left_pwm_counts < 0 < says.right_pwm_counts
        shown.forget()
        begin_ns, pressed_us = time.monotonic_ns(), robot.simulator.now()
        shown.type(b" ")
        shown.wait_for("STOPPED: base has confirmed")
        took = stop_time(robot, pressed_us)
        print(f"space bar: PWM 0 after {took:.3f} s")
        with by_the_wall(begin_ns):
            assert took <= 0.35
        shown.wait_for("EMERGENCY STOP, engaged by keyboard@")
        hold(shown, b"w", 1.0)
        assert robot.simulator.record(pressed_us + 500_000).driven_ms == 0

        assert robot.giraff("estop", "reset") == 0
        shown.forget()
        shown.wait_for("keyboard drives   armed")
        with by_the_wall():
            hold(shown, b"s", 1.0)
            assert robot.drives()
        shown.type(b"\x03")
        assert shown.process.wait(10.0) == 0
        assert shown.is_restored()
        with by_the_wall():
            ended_us = robot.simulator.now()
            assert stop_time(robot, ended_us) <= STOPS_WITHIN


def test_what_is_typed_pasted_or_torn_while_it_sleeps_or_not_moves_nothing(tmp_path: Path) -> None:
    with keyboard(tmp_path) as (robot, shown):
        take(shown)
        began_us = robot.simulator.now()
        for paste in (b"wwwwww", b"\x1b[200~wasd\x1b[201~", b"cd /w\n"[:4] + b"w", b"\x1b[1;5A", b"\x1bw"):
            shown.type(paste)
            robot.run(0.3)
        shown.process.send_signal(signal.SIGSTOP)
        for _ in range(10):
            shown.type(b"w")
            robot.run(0.1)
        shown.process.send_signal(signal.SIGCONT)
        robot.run(1.0)
        assert robot.simulator.record(began_us).driven_ms == 0


def test_killed_it_drives_nothing_any_more(tmp_path: Path) -> None:
    with process_robot(tmp_path, boards="host") as robot:
        robot.stop("joystick")
        with screen(KEYBOARD, tmp_path / "keyboard.log", robot.environment) as shown:
            shown.wait_for("nobody drives")
            take(shown)
            with by_the_wall():
                hold(shown, b"w", 1.0)
                assert robot.drives()
                shown.process.kill()
                took = stop_time(robot, robot.simulator.now())
                print(f"SIGKILL: PWM 0 after {took:.3f} s")
                assert took <= STOPS_WITHIN
