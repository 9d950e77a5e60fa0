"""The guard numbers the commands that it has heard by each turn, and a replay goes by that."""

import msgspec

from giraff_cli.replay.policies import RecordedSamples, _Inputs
from giraff_schemas.messages import DriveCommand, GuardedCommand
from tests.unit.cli.samples import MS, command, wish
from tests.unit.odometry.robots import ROBOT

AT = 1_767_000_000_000_000_000  # ns


def sent(seq: int, after_ms: int) -> DriveCommand:
    sample = msgspec.structs.replace(wish(0.1 * seq, 0.0, 5000 * MS), seq=seq)
    return msgspec.structs.replace(sample, stamp_ns=AT + after_ms * MS, instance="hand")


def turn(after_ms: int) -> GuardedCommand:
    return msgspec.structs.replace(command(5000 * MS), stamp_ns=AT + after_ms * MS, instance="guard")


def test_a_guard_that_numbers_what_it_has_heard_is_believed_whatever_the_stamps() -> None:
    said = RecordedSamples()
    for seq in (1, 2, 4, 5):
        said.add(sent(seq, seq))
    inputs = _Inputs(said, ROBOT)
    found = []
    for after_ms, newest in ((20, 1), (40, 2), (60, 5), (80, 5)):
        numbered = msgspec.structs.replace(turn(after_ms), heard=(-1, -1, newest))
        found.append(([sample.seq for sample in inputs.until(numbered)], inputs.lacks))
    assert found == [([1], False), ([2], False), ([4, 5], True), ([], False)]
