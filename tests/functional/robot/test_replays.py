"""Nothing old moves the robot: a recorded drive said again, and a reset of the emergency stop said again."""

from __future__ import annotations

import time
from pathlib import Path

from giraff_node.asking import Asking
from giraff_schemas.messages import EStopAnswer, EStopEngage, EStopReset
from giraff_schemas.topics import ESTOP, ESTOP_ENGAGE, ESTOP_RESET, TICK
from tests.support.process_robot import ARENA, ProcessRobot, process_robot
from tests.support.replays import record_drive, say_again

LATE = 8.0
"""s; TCP has been seen to hand over commands that old after a cut."""


def test_a_drive_that_is_said_again_moves_nothing_with_or_without_its_makers(tmp_path: Path) -> None:
    with process_robot(tmp_path, ARENA) as robot:
        said = record_drive(robot, 1.0)
        robot.arm()  # the very operator whose words they are holds the hand level, and could drive at any moment
        since_us = robot.simulator.now()
        say_again(robot, said, LATE)
        robot.run(0.5)
        verdict = robot.simulator.record(since_us)
        assert verdict.driven_ms == 0
        assert verdict.accepted > 100, "base goes on sending zeros"
        for service in ("joystick", "guard", "ranger"):
            robot.kill(service)
        since_us = robot.simulator.now()
        say_again(robot, said, time.monotonic() - said[0].at)
        robot.run(0.5)
        assert robot.simulator.record(since_us).driven_ms == 0
        for service in ("joystick", "guard", "ranger"):
            robot.start(service)
        robot.drive_forward()


def ask(robot: ProcessRobot, request: EStopEngage | EStopReset) -> EStopAnswer:
    """The answer of base."""
    name = robot.environment["GIRAFF_ROBOT_NAME"]
    session = robot.observer.session
    asking: Asking[EStopEngage, EStopAnswer] | Asking[EStopReset, EStopAnswer] = (
        Asking(session, name, ESTOP_ENGAGE, request)
        if isinstance(request, EStopEngage)
        else Asking(session, name, ESTOP_RESET, request)
    )
    robot.wait("the answer of base", lambda: asking.poll(time.monotonic()) is not None, 5.0)
    answer = asking.poll(time.monotonic())
    assert answer is not None
    return answer


def fresh_reset(robot: ProcessRobot, latch: int) -> EStopReset:
    tick = robot.observer.newest(TICK)
    assert tick is not None
    return EStopReset(by="test", id=latch, tick=tick.time)


def test_a_reset_that_is_said_again_clears_nothing_and_one_that_counts_moves_nothing(tmp_path: Path) -> None:
    with process_robot(tmp_path, ARENA) as robot:
        for topic in (TICK, ESTOP):
            robot.observer.follow(topic)
        robot.drive_forward()
        first = ask(robot, EStopEngage(by="test", reason="first"))
        assert (first.done, first.engaged) == (True, True)
        since_us = robot.simulator.now() + 350_000
        old = fresh_reset(robot, first.id)  # said 8 s from now only
        robot.run(LATE)
        late = ask(robot, old)
        assert (late.done, late.engaged) == (False, True), late
        heeded = fresh_reset(robot, first.id)
        cleared = ask(robot, heeded)
        assert (cleared.done, cleared.engaged) == (True, False), cleared
        robot.run(1.5)  # the hand is tilted all the time: a reset permits motion and never causes it
        second = ask(robot, EStopEngage(by="test", reason="second"))
        assert second.id != first.id
        again = ask(robot, heeded)
        assert (again.done, again.engaged) == (False, True), again
        assert robot.simulator.record(since_us).driven_ms == 0
        assert ask(robot, fresh_reset(robot, second.id)).done
        robot.drive_forward()
