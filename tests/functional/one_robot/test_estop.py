"""`giraff stop` and `giraff estop` from any machine, against the whole robot."""

import socket
import threading
from contextlib import ExitStack

from giraff_core.estop.request import BY_WORD
from tests.support.elsewhere import giraff
from tests.support.process_robot import BRIEF, FULL_TILT, PATIENCE, ProcessRobot


def test_it_stops_stays_stopped_and_is_reset_for_a_level_hand_only(robot: ProcessRobot) -> None:
    robot.drive_forward(BRIEF)
    told = giraff(robot, "estop", "sim-test", "--reason", "a cat", name=None)
    stopped_us = robot.simulator.now() + 350_000  # the board's own time-out is 0.3 s
    assert (told.returncode, told.stderr) == (0, "")
    assert told.stdout.startswith("sim-test: STOPPED, latch ")
    told = giraff(robot, "estop", "status")
    assert told.returncode == 1
    assert "sim-test: ENGAGED, latch " in told.stdout
    assert ": a cat" in told.stdout
    robot.hold(0.0, 0.0)
    robot.run(0.7)
    robot.hold(FULL_TILT, 0.0)
    robot.run(0.7)
    told = giraff(robot, "estop", "reset")
    assert (told.returncode, told.stderr) == (0, "")
    assert "cleared latch " in told.stdout
    assert ": a cat" in told.stdout
    robot.run(1.0)
    assert robot.simulator.record(stopped_us).driven_ms == 0, "the robot moved before a level hand"
    assert giraff(robot, "estop", "status").returncode == 0
    robot.drive_forward(BRIEF)


ODD = ("giraff/a b/alive/base/x", "giraff/\x1b[2J/alive/base/x", "giraff/**")
"""Liveliness tokens that anybody may declare."""


def test_it_survives_a_restart_and_is_engaged_without_a_name(robot: ProcessRobot) -> None:
    with ExitStack() as declared:
        for token in ODD:
            declared.enter_context(robot.observer.session.liveliness().declare_token(token))
        told = giraff(robot, "stop", "--timeout", "60", name=None)
    assert told.returncode == 0, told
    assert sorted(line.partition("left out: ")[2] for line in told.stderr.splitlines()) == sorted(map(ascii, ODD))
    robot.kill("base")
    robot.start("base")

    def is_still_stopped() -> bool:
        """Asked again: until another service has taken the rendezvous, nobody is met there."""
        told = giraff(robot, "estop", "status", "--timeout", "60", name=None)
        assert told.returncode in (1, 2), told  # 2: nobody is met yet. The stop is never gone.
        return told.returncode == 1 and "stopped by hand" in told.stdout

    robot.wait("the stop from before", is_still_stopped, PATIENCE)
    told = giraff(robot, "estop", "reset", "--timeout", "60", name=None)
    assert told.returncode == 2, "what is no simulation of this host is released only by its name"
    assert "--robot sim-test" in told.stderr
    assert giraff(robot, "estop", "reset", "--timeout", "60").returncode == 0


def test_a_broken_robot_file_stops_no_stop(robot: ProcessRobot) -> None:
    robot.drive_forward(BRIEF)
    file = robot.directory / "nowhere" / "deploy" / "robot.toml"
    file.parent.mkdir(parents=True)
    file.write_bytes(b'# K\xfcche\n[robot]\nname = "other\n')
    told = giraff(robot, "stop")
    stopped_us = robot.simulator.now() + 350_000
    file.unlink()
    asked, remedy = told.stderr.splitlines()
    assert (told.returncode, told.stdout) == (2, "")
    doubt = "whether it is yours is not known: deploy/robot.toml cannot be read"
    assert asked == f"a robot called sim-test at {socket.gethostname()} has stopped, {BY_WORD}; {doubt}"
    assert remedy.startswith("giraff: deploy/robot.toml: not TOML: ")
    assert "use the battery switch, or without the file: env GIRAFF_CONFIG=/dev/null" in remedy
    robot.run(0.5)
    assert robot.simulator.record(stopped_us).driven_ms == 0


def test_what_no_base_confirms_is_no_stop_until_one_is_back(robot: ProcessRobot) -> None:
    robot.kill("base")
    told = giraff(robot, "estop", "engage", "--timeout", "1")
    assert told.returncode == 2
    assert "NOT CONFIRMED after 1 s: nobody answered" in told.stderr
    assert "use the battery switch" in told.stderr
    codes: list[int] = []
    engaging = threading.Thread(
        target=lambda: codes.append(giraff(robot, "estop", "engage", "--timeout", "60").returncode)
    )
    engaging.start()
    robot.run(1.0)
    robot.start("base")
    engaging.join()
    assert codes == [0], "asked again until base was back"
