"""`giraff estop` from any machine, against the whole robot."""

from __future__ import annotations

import threading
import time
from pathlib import Path

from tests.support.elsewhere import giraff
from tests.support.process_robot import FULL_TILT, ProcessRobot, process_robot
from tests.timing.stalled import by_the_wall


def stop_time(robot: ProcessRobot) -> float:
    """Engage while the robot drives: s from base's word to PWM zero, negative when it was zero before."""
    robot.drive_forward()
    began_us = robot.simulator.now()
    told = giraff(robot, "estop", "engage", "--reason", "a cat")
    confirmed_us = robot.simulator.now()
    assert (told.returncode, told.stderr) == (0, "")
    assert told.stdout.startswith("sim-test: STOPPED, latch ")
    robot.run(0.5)
    last_us = robot.simulator.record(began_us).last_driven_us
    assert last_us is not None
    return (last_us - confirmed_us) * 1e-6


def test_it_stops_stays_stopped_and_is_reset_for_a_level_hand_only(tmp_path: Path) -> None:
    with process_robot(tmp_path) as robot:
        begin_ns = time.monotonic_ns()
        took = stop_time(robot)
        print(f"PWM 0 {took:+.3f} s after base's word")
        with by_the_wall(begin_ns):
            assert took <= 0.05
        told = giraff(robot, "estop", "status")
        assert told.returncode == 1
        assert "sim-test: ENGAGED, latch " in told.stdout
        assert ": a cat" in told.stdout
        stopped_us = robot.simulator.now()
        robot.hold(0.0, 0.0)
        robot.run(1.0)
        robot.hold(FULL_TILT, 0.0)
        robot.run(1.0)
        told = giraff(robot, "estop", "reset")
        assert (told.returncode, told.stderr) == (0, "")
        assert "cleared latch " in told.stdout
        assert ": a cat" in told.stdout
        robot.run(1.5)
        assert robot.simulator.record(stopped_us).driven_ms == 0, "the robot moved before a level hand"
        assert giraff(robot, "estop", "status").returncode == 0
        robot.drive_forward()


def test_it_survives_a_restart_and_needs_no_name_where_there_is_one_robot(tmp_path: Path) -> None:
    with process_robot(tmp_path, boards="host") as robot:
        assert giraff(robot, "estop", "engage", name=None).returncode == 0
        robot.kill("base")
        robot.start("base")
        told = giraff(robot, "estop", "status", "--timeout", "10", name=None)
        assert told.returncode == 1, told
        assert "stopped by hand" in told.stdout
        assert giraff(robot, "estop", "reset", "--timeout", "10", name=None).returncode == 0
        told = giraff(robot, "estop", "reset")
        assert told.returncode == 0
        assert "not engaged, nothing to clear" in told.stdout


def test_what_no_base_confirms_is_no_stop(tmp_path: Path) -> None:
    with process_robot(tmp_path, boards="host") as robot:
        robot.kill("base")
        told = giraff(robot, "estop", "engage", "--timeout", "1")
        assert told.returncode == 2
        assert "NOT CONFIRMED after 1 s: nobody answered" in told.stderr
        assert "use the battery switch" in told.stderr
        told = giraff(robot, "estop", "engage", "--timeout", "1", name="otto")
        assert told.returncode == 2
        assert "on the network: --robot sim-test" in told.stderr
        codes: list[int] = []
        engaging = threading.Thread(
            target=lambda: codes.append(giraff(robot, "estop", "engage", "--timeout", "20").returncode)
        )
        engaging.start()
        time.sleep(1.0)
        robot.start("base")
        engaging.join()
        assert codes == [0], "asked again until base was back"
