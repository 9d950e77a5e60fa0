"""The keyboard as it really runs: a process in a terminal, somebody who types, and the board's own record."""

import signal
from collections.abc import Iterator

import pytest

from tests.support.keyboard_user import drive, drive_by, hold, keyboard, press_until, take
from tests.support.process_robot import PATIENCE, ProcessRobot, process_robot


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ProcessRobot]:
    """Whose only operator is a keyboard."""
    with process_robot(tmp_path_factory.mktemp("robot"), boards="host") as made:
        made.stop("joystick")
        yield made


def stands_still(robot: ProcessRobot) -> bool:
    """Tell whether it stands once the last command is too old.

    A machine that pauses stops the robot early, and it may drive on by a command that is still fresh.
    """
    robot.wait("standing", lambda: not robot.drives(), PATIENCE)
    stopped_us = robot.simulator.now() + 500_000  # no command lasts longer
    robot.run(1.0)
    return robot.simulator.record(stopped_us).driven_ms == 0


def latch_of(robot: ProcessRobot) -> str:
    says = robot.simulator.state().base
    return "" if says is None else says.latch


def test_it_takes_arms_drives_and_stops_by_the_space_bar(robot: ProcessRobot) -> None:
    with keyboard(robot) as shown:
        robot.run(1.0)
        assert "yours," not in shown.read()  # nobody takes a robot by starting a program
        take(shown)
        drive_by(robot, shown, b"w")
        assert stands_still(robot), "it drives on with no key held"
        drive_by(robot, shown, b"\x1b[D")
        says = robot.simulator.state().base
        assert says is not None
        assert says.left_pwm_counts <= 0 <= says.right_pwm_counts
        shown.forget()
        shown.type(b" ")
        shown.wait_for("STOPPED: base has confirmed", PATIENCE)
        confirmed_us = robot.simulator.now()
        shown.wait_for("base has confirmed. By keyboard@", PATIENCE)
        hold(shown, b"w", 1.0)
        assert robot.simulator.record(confirmed_us + 350_000).driven_ms == 0  # the board's own time-out is 0.3 s

        assert robot.giraff("estop", "reset") == 0
        take(shown)
        drive_by(robot, shown, b"s")
        shown.type(b"\x03")
        assert shown.ended(PATIENCE) == 0
        assert shown.is_restored()
        assert stands_still(robot)


def test_giraff_drive_takes_arms_drives_stops_and_releases_on_one_screen_without_a_robot_file(
    robot: ProcessRobot,
) -> None:
    with drive(robot) as shown:
        assert "yours," not in shown.read()  # nobody takes a robot by starting a program
        take(shown)
        drive_by(robot, shown, b"w")
        robot.wait("standing", lambda: not robot.drives(), PATIENCE)
        shown.type(b" ")
        shown.wait_for("STOPPED: base has confirmed", PATIENCE)
        confirmed_us = robot.simulator.now()
        hold(shown, b"w", 0.5)
        press_until(shown, b"r", "RELEASE? y: yes")
        robot.run(1.0)  # to read what is asked
        shown.type(b"y")
        shown.wait_for("released; SPACE engages it", PATIENCE)
        shown.wait_for("yours, armed", PATIENCE)
        assert robot.simulator.record(confirmed_us).driven_ms == 0, "a release moves it"
        drive_by(robot, shown, b"s")
        shown.type(b"\x03")
        assert shown.ended(PATIENCE) == 0
        assert shown.is_restored()
        assert shown.read().rstrip().endswith("\x1b[?2004l")
        assert stands_still(robot)


def test_a_terminal_that_takes_nothing_holds_up_neither_the_stop_nor_the_end(robot: ProcessRobot) -> None:
    with drive(robot) as shown:
        take(shown)
        shown.fill()
        robot.run(1.0)  # it shows something new each moment
        shown.fill()
        shown.type(b" ")
        robot.wait("the emergency stop", lambda: latch_of(robot) == "estop", PATIENCE)
        shown.type(b"\x03")
        assert shown.ended(PATIENCE) == 0
        assert shown.is_restored()
    assert robot.giraff("estop", "reset") == 0


def test_what_is_typed_pasted_or_torn_while_it_sleeps_or_not_moves_nothing(robot: ProcessRobot) -> None:
    with keyboard(robot) as shown:
        take(shown)
        began_us = robot.simulator.now()
        for paste in (b"wwwwww", b"\x1b[200~wasd\x1b[201~", b"ls\nw", b"\x1b[1;5A", b"\x1bw"):
            shown.type(paste)
            robot.run(0.3)
        shown.process.send_signal(signal.SIGSTOP)
        for _ in range(10):
            shown.type(b"w")
            robot.run(0.1)
        shown.process.send_signal(signal.SIGCONT)
        robot.run(1.0)
        assert robot.simulator.record(began_us).driven_ms == 0
        assert "ENGAGED" not in shown.text, "it could not have moved anyway"
        take(shown)
        drive_by(robot, shown, b"w")
        shown.process.kill()
        assert stands_still(robot), "it drives on without a keyboard"
