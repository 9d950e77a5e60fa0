"""The guard numbers the commands that it has heard by each turn, and a replay goes by that."""

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
