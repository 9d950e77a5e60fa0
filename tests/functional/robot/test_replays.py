"""Nothing that is said again moves the robot, neither a drive nor a reset. Nor does a second hand."""

import time
from collections.abc import Iterator

import pytest

from giraff_node.network.query_client import QueryClient
from giraff_schemas.requests import EStopAnswer, EStopEngage, EStopReset
from giraff_schemas.topics import ESTOP, ESTOP_ENGAGE, ESTOP_RESET, TICK
from giraff_schemas.trouble import Trouble
from tests.support.process_robot import ARENA, BRIEF, FULL_TILT, PATIENCE, ProcessRobot, process_robot
from tests.support.replays import record_drive, say_again

LATE = 2.5
"""s; what is a minute old, as TCP has been seen to hand it over after a cut, is tests/dst/test_replays.py's."""


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ProcessRobot]:
    with process_robot(tmp_path_factory.mktemp("robot"), ARENA, boards="host") as made:
        yield made


def test_a_drive_that_is_said_again_moves_nothing_with_or_without_its_makers(robot: ProcessRobot) -> None:
    said = record_drive(robot, 0.5)
    robot.arm()  # the very operator whose words they are holds the hand level, and could drive at any moment
    robot.wait("rest after the drive itself", lambda: not robot.drives(), PATIENCE)
    since_us = robot.simulator.now()
    say_again(robot, said, LATE)
    robot.run(0.5)
    verdict = robot.simulator.record(since_us)
    assert verdict.driven_ms == 0
    assert verdict.accepted > 0, "base goes on sending zeros"
    for service in ("joystick", "guard", "ranger"):
        robot.kill(service)
    since_us = robot.simulator.now()
    say_again(robot, said, time.monotonic() - said[0].at)
    robot.run(0.5)
    assert robot.simulator.record(since_us).driven_ms == 0
    for service in ("joystick", "guard", "ranger"):
        robot.start(service)
    robot.drive_forward(BRIEF)


def ask(robot: ProcessRobot, request: EStopEngage | EStopReset) -> EStopAnswer:
    """The answer of base."""
    name = robot.environment["GIRAFF_ROBOT_NAME"]
    session = robot.observer.session
    asking: QueryClient[EStopEngage, EStopAnswer] | QueryClient[EStopReset, EStopAnswer] = (
        QueryClient(session, name, ESTOP_ENGAGE, request)
        if isinstance(request, EStopEngage)
        else QueryClient(session, name, ESTOP_RESET, request)
    )
    robot.wait("the answer of base", lambda: asking.poll(time.monotonic()) is not None, PATIENCE)
    answer = asking.poll(time.monotonic())
    assert answer is not None
    return answer


def fresh_reset(robot: ProcessRobot, latch: int) -> EStopReset:
    tick = robot.observer.newest(TICK)
    assert tick is not None
    return EStopReset(by="test", id=latch, tick=tick.time)


def clear(robot: ProcessRobot, latch: int) -> EStopReset:
    """The reset that base has heeded: another one where this machine stood still, and made it too old on its way."""
    deadline = time.monotonic() + PATIENCE
    while True:
        reset = fresh_reset(robot, latch)
        answer = ask(robot, reset)
        if answer.done:
            assert not answer.engaged
            return reset
        assert time.monotonic() < deadline, answer


def test_a_reset_that_is_said_again_clears_nothing_and_one_that_counts_moves_nothing(robot: ProcessRobot) -> None:
    for topic in (TICK, ESTOP):
        robot.observer.follow(topic)
    robot.drive_forward(BRIEF)
    first = ask(robot, EStopEngage(by="test", reason=Trouble("first")))
    assert (first.done, first.engaged) == (True, True)
    since_us = robot.simulator.now() + 350_000
    old = fresh_reset(robot, first.id)  # said later only
    robot.run(LATE)
    late = ask(robot, old)
    assert (late.done, late.engaged) == (False, True), late
    heeded = clear(robot, first.id)
    robot.run(1.0)  # the hand is tilted all the time: a reset permits motion and never causes it
    second = ask(robot, EStopEngage(by="test", reason=Trouble("second")))
    assert second.id != first.id
    again = ask(robot, heeded)
    assert (again.done, again.engaged) == (False, True), again
    assert robot.simulator.record(since_us).driven_ms == 0
    clear(robot, second.id)
    robot.drive_forward(BRIEF)


def test_a_second_joystick_of_the_same_name_moves_nothing(robot: ProcessRobot) -> None:
    robot.arm()
    since_us = robot.simulator.now() + 350_000  # the robot may have driven until now
    with robot.start_second_hand() as other:
        other.tilt(FULL_TILT, 0.0)
        robot.wait(
            "that the second is told who holds the lease",
            lambda: any("held by joystick" in message for message in robot.messages("second joystick")),
            PATIENCE,
        )
        robot.run(1.0)
        assert robot.simulator.record(since_us).driven_ms == 0
    robot.stop("second joystick")
    robot.stop("second simulator")
