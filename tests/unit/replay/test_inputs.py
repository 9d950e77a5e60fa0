"""Which of the recorded commands the guard had heard by a turn of its, where two carry one moment of the robot."""

from __future__ import annotations

import msgspec

from giraff_cli.replay.policies import RecordedSamples, _Inputs
from giraff_schemas.messages import DriveCommand, GuardedCommand, RobotTime
from tests.unit.odometry.robots import ROBOT

MOMENT = RobotTime(epoch=1, robot_ns=5_000_000_000)
AT = 1_767_000_000_000_000_000  # ns
MS = 1_000_000


def command(seq: int, after_ms: int) -> DriveCommand:
    return DriveCommand(
        seq=seq,
        stamp_ns=AT + after_ms * MS,
        instance="hand",
        operator="joystick",
        lease_counter=1,
        linear_x=0.1 * seq,
        angular_z=0.0,
        source="hand",
        tick=MOMENT,
    )


def turn(after_ms: int) -> GuardedCommand:
    return GuardedCommand(
        stamp_ns=AT + after_ms * MS,
        instance="guard",
        linear_x=0.0,
        angular_z=0.0,
        guard_tick=MOMENT,
        operator="hand",
        lease_counter=1,
        operator_tick=MOMENT,
        range_tick=None,
        source="hand",
        faults=0,
        hand_neutral=False,
    )


def heard(commands: list[DriveCommand], turns: list[GuardedCommand]) -> list[list[int]]:
    """The numbers of those that are new in each turn."""
    said = RecordedSamples()
    for each in commands:
        said.add(each)
    inputs = _Inputs(said, ROBOT)
    return [[sample.seq for sample in inputs.until(each)] for each in turns]


def test_one_that_repeats_a_moment_is_heard_when_it_was_said() -> None:
    assert heard([command(1, 0), command(2, 18)], [turn(1), turn(19)]) == [[1], [2]]


def test_the_first_of_a_moment_is_heard_in_the_turn_that_tells_it_whatever_its_stamp() -> None:
    """The hand's clock is another one's."""
    late = command(1, 4)
    assert heard([late], [turn(1)]) == [[1]]
    newer = msgspec.structs.replace(late, tick=RobotTime(epoch=1, robot_ns=MOMENT.robot_ns + 1))
    assert heard([newer], [turn(1)]) == [[]]


def test_a_guard_that_numbers_what_it_has_heard_is_believed_whatever_the_stamps() -> None:
    said = RecordedSamples()
    for seq in (1, 2, 4, 5):
        said.add(command(seq, seq))
    inputs = _Inputs(said, ROBOT)
    found = []
    for after_ms, newest in ((20, 1), (40, 2), (60, 5), (80, 5)):
        numbered = msgspec.structs.replace(turn(after_ms), heard=(-1, -1, newest))
        found.append(([sample.seq for sample in inputs.until(numbered)], inputs.lacks))
    assert found == [([1], False), ([2], False), ([4, 5], True), ([], False)]
