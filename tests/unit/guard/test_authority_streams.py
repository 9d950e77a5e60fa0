"""Whatever comes, in whatever order: only what the holder freshly says under its lease ever passes."""

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from giraff_schemas.messages import DriveCommand, Source
from tests.unit.guard.lease import EPOCH, FIRST, PERIOD, Room


@pytest.mark.parametrize("late", range(1, 61))
def test_a_replayed_stream_counts_nothing(held: Room, late: int) -> None:
    """All that A said for four seconds, again: beside its own live stream, and then beside another's."""
    recorded: list[DriveCommand] = []
    for number in range(80):
        held.wait(PERIOD)
        recorded.append(held.say("A", FIRST if number > 1 else 0, 0.5))
    held.drive("A", late, -0.1)
    for command in recorded:
        held.authority.on_command(command, held.now)
        assert (held.holder, held.passes) == ("A", -0.1)
    held.say("A", FIRST, -0.2)
    assert held.passes == -0.2
    held.wait(1.1)
    held.say("B", 0)
    held.say("B", held.authority.counter, 0.2)
    for number, command in enumerate(recorded):
        # The same with each counter that there was, and with numbers above the live ones.
        for counter in (0, FIRST, held.authority.counter):
            forged = msgspec.structs.replace(command, lease_counter=counter, seq=10_000 + number)
            held.authority.on_command(forged, held.now)
            assert (held.holder, held.passes) == ("B", 0.2)


@given(
    story=st.lists(
        st.tuples(
            st.sampled_from("ABC"),
            st.sampled_from([0, FIRST - 1, FIRST, FIRST + 1, FIRST + 2]),
            st.floats(-1.0, 1.0),
            st.sampled_from(["hand", "hand", "hand", "fault"]),
            st.sampled_from([0.0, 0.1, 0.39, 0.41, 5.0, -0.1]),
            st.integers(0, 40),
            st.sampled_from(["joystick", "carer"]),
            st.sampled_from([0.0, 0.02, 0.2, 0.5, 1.2, 2.5]),
            st.sampled_from([EPOCH, EPOCH, EPOCH, EPOCH + 1, 0]),
        ),
        max_size=40,
    )
)
def test_only_what_the_holder_freshly_says_under_its_lease_ever_passes(
    story: list[tuple[str, int, float, Source, float, int, str, float, int]],
) -> None:
    room = Room()
    for instance, counter, linear, source, age, seq, name, pause, epoch in story:
        room.wait(pause)
        before = room.authority.counter
        room.say(instance, counter, linear, name=name, source=source, age=age, seq=seq, epoch=epoch)
        fresh = epoch == EPOCH and 0.0 <= age <= 0.4
        room.authority.review(room.now)
        if room.authority.counter not in (before, 0):
            assert counter == 0
            assert fresh
            assert source == "hand"
        passed, _ = room.authority.asked(room.now)
        if passed is not None:
            assert passed.instance == room.authority.holder
            assert passed.lease_counter == room.authority.counter != 0
            assert passed.source == "hand"
            assert passed.tick is not None
            assert passed.tick.epoch == EPOCH
            assert 0 <= room.robot_ns - passed.tick.robot_ns <= 0.4e9
