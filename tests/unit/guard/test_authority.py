"""Who drives: how the lease is granted, kept, taken and lost, and what a command needs to count."""

import math

import pytest

from giraff_core.lease import IDLE, unranked_notice
from giraff_schemas.messages import Source
from giraff_schemas.services import HANDS
from giraff_schemas.trouble import NO_TROUBLE
from tests.unit.guard.lease import FIRST, PERIOD, Room


def test_a_free_lease_goes_to_the_first_who_asks(room: Room) -> None:
    room.say("A", 0)
    room.say("B", 0)
    assert (room.holder, room.authority.operator, room.authority.counter) == ("A", "joystick", FIRST)


def test_the_asking_command_itself_moves_nothing(room: Room) -> None:
    room.say("A", 0, 0.5)
    assert room.holder == "A"
    assert room.passes is None
    room.say("A", 0, 0.5)
    assert room.passes is None
    room.say("A", FIRST, 0.5)
    assert room.passes == 0.5


@pytest.mark.parametrize("counter", [-1, FIRST - 1])
def test_a_holder_that_was_told_of_an_old_lease_asks_for_nothing_until_it_hears_of_its_own(
    held: Room, counter: int
) -> None:
    held.say("A", FIRST, 0.5, seq=10)
    held.say("A", counter, -0.5, seq=12)
    assert held.passes is None
    assert "joystick has not heard under which lease it drives" in str(held.authority.asked(held.now)[1])
    held.say("A", FIRST, 0.5, seq=11)  # overtaken
    assert held.passes is None
    again = held.say("A", FIRST, -0.5, seq=13)
    assert held.authority.asked(held.now) == (again, NO_TROUBLE)
    assert held.authority.counter == FIRST


def test_faults_of_holders_are_counted(held: Room) -> None:
    counts = []
    for source in ("hand", "fault", "fault", "hand", "fault"):
        held.say("A", FIRST, source=source)
        counts.append(held.authority.faults)
    held.say("A", FIRST, source="hand")
    held.say("A", FIRST, source="fault", age=math.inf)  # of no known age, but its newest word
    held.say("B", 0, source="fault")  # holds nothing
    assert (counts, held.authority.faults) == ([0, 1, 1, 1, 2], 3)


@pytest.mark.parametrize("counter", [1, FIRST - 1, FIRST, FIRST + 1])
def test_one_who_has_not_asked_moves_nothing(room: Room, counter: int) -> None:
    for _ in range(5):
        room.say("A", counter, 0.5)
        assert (room.holder, room.passes) == ("", None)


@pytest.mark.parametrize(
    ("age", "granted"), [(0.0, True), (0.4, True), (0.4 + 1e-9, False), (8.0, False), (-0.1, False)]
)
def test_asking_needs_a_fresh_command(room: Room, age: float, granted: bool) -> None:
    room.say("A", 0, age=age)
    assert room.holder == ("A" if granted else "")


def test_a_fault_does_not_ask(room: Room) -> None:
    room.say("A", 0, source="fault")
    assert room.holder == ""
    assert str(room.authority.reason(room.now)) == "joystick: the hand is lost"


@pytest.mark.parametrize(
    ("age", "counts"), [(0.0, True), (0.4, True), (0.4 + 1e-9, False), (8.0, False), (-0.1, False)]
)
def test_only_fresh_commands_of_the_holder_count(held: Room, age: float, counts: bool) -> None:
    held.say("A", FIRST, 0.5, age=age)
    assert held.passes == (0.5 if counts else None)


def test_a_command_stops_counting_when_it_gets_old(held: Room) -> None:
    held.say("A", FIRST, 0.5)
    held.wait(0.4)
    assert held.passes
    held.wait(1e-9)
    assert not held.passes
    assert held.holder == "A"


def test_another_operators_commands_do_not_count(held: Room) -> None:
    held.say("A", FIRST, 0.1)
    for counter in (0, FIRST, FIRST + 1):
        held.say("B", counter, 0.5)
        assert (held.holder, held.passes) == ("A", 0.1)


def test_a_second_process_of_the_same_name_is_refused_and_told(held: Room) -> None:
    held.say("A", FIRST, 0.5)
    held.say("A2", 0, -0.5, name="joystick")
    assert (held.holder, held.passes) == ("A", 0.5)
    reason = str(held.authority.reason(held.now))
    assert "held by joystick (A)" in reason
    for remedy in ("rests for 30 s", "silent for 1 s", "at fault for 2 s", "to ask", "to arm"):
        assert remedy in reason


@pytest.mark.parametrize("seq", [9, 10, 0])
def test_a_repeated_or_reordered_command_does_not_count(held: Room, seq: int) -> None:
    held.say("A", FIRST, 0.5, seq=10)
    held.say("A", FIRST, -0.5, seq=seq)
    assert held.passes == 0.5
    held.say("A", FIRST, -0.5, seq=11)
    assert held.passes == -0.5


def test_a_high_number_that_is_not_the_holders_does_not_shut_it_out(held: Room) -> None:
    held.say("B", FIRST, 0.5, seq=20_000)
    held.say("A", FIRST, -0.3, seq=11)
    assert held.passes == -0.3


def test_a_number_far_ahead_does_not_shut_out_the_holder(held: Room) -> None:
    held.say("A", FIRST, 0.5, seq=10)
    for age in (0.0, 2.0):
        held.say("A", FIRST, 0.1, seq=10_000, age=age)
        assert held.passes == 0.5
    held.say("A", FIRST, -0.3, seq=1010)
    assert held.passes == -0.3


@pytest.mark.parametrize("source", ["hand", "fault"])
def test_the_holders_newest_word_ends_the_one_before_even_where_its_age_is_not_proven(
    held: Room, source: Source
) -> None:
    held.say("A", FIRST, 0.5, seq=10)
    held.say("A", FIRST, seq=12, source=source, age=math.inf)
    assert held.passes is None
    assert "joystick: " in str(held.authority.asked(held.now)[1])
    held.say("A", FIRST, 0.5, seq=11)  # overtaken
    assert held.passes is None
    held.say("A", FIRST, -0.3, seq=13)
    assert held.passes == -0.3


def test_a_word_whose_age_is_not_proven_does_not_keep_the_lease(held: Room) -> None:
    for _ in range(21):
        held.wait(PERIOD)
        held.say("A", FIRST, age=math.inf)
    assert held.holder == ""


@pytest.mark.parametrize(("silence", "kept"), [(0.5, True), (1.0, True), (1.0 + 1e-9, False)])
def test_silence_ends_the_lease(held: Room, silence: float, kept: bool) -> None:
    held.drive("A", 3.0, 0.5)
    held.wait(silence)
    assert held.holder == ("A" if kept else "")
    if not kept:
        assert "joystick was silent for 1 s" in str(held.authority.reason(held.now))


@pytest.mark.parametrize(
    ("source", "speed", "told"),
    [("hand", 0.0, IDLE.what), ("fault", 0.0, IDLE.what), ("hand", 0.3, "joystick was silent")],
)
def test_a_holder_that_goes_at_rest_leaves_the_robot_idle(held: Room, source: Source, speed: float, told: str) -> None:
    """A motion that has arrived says no more, and is no fault."""
    held.drive("A", 1.0, 0.5)
    held.drive("A", 0.5, speed, source=source)
    held.wait(1.1)
    assert held.holder == ""
    assert told in held.authority.reason(held.now).what


def test_without_any_operator_it_is_told_that_none_is_heard(room: Room) -> None:
    assert room.authority.reason(room.now).what == "no operator is heard"
    room.say("A", FIRST)
    assert room.authority.reason(room.now) == IDLE


@pytest.mark.parametrize("wrong", ["stale", "foreign", "old lease", "repeated", "asking"])
def test_what_does_not_count_does_not_keep_the_lease(held: Room, wrong: str) -> None:
    held.say("A", FIRST, 0.5, seq=100)
    for number in range(21):
        held.wait(PERIOD)
        match wrong:
            case "stale":
                held.say("A", FIRST, 0.5, seq=101 + number, age=0.5)
            case "foreign":
                held.say("B", FIRST, 0.5, seq=101 + number)
            case "old lease":
                held.say("A", FIRST - 1, 0.5, seq=101 + number)
            case "repeated":
                held.say("A", FIRST, 0.5, seq=100)
            case _:
                held.say("A", 0, seq=101 + number) if number < 19 else None
    assert held.holder == ""


@pytest.mark.parametrize(("seconds", "kept"), [(1.9, True), (2.1, False)])
def test_a_fault_ends_the_lease(held: Room, seconds: float, kept: bool) -> None:
    held.drive("A", 5.0, 0.5)
    held.drive("A", seconds, source="fault")
    assert held.passes is None
    assert held.holder == ("A" if kept else "")
    if kept:
        assert str(held.authority.asked(held.now)[1]) == "joystick: the hand is lost"
    else:
        assert "joystick was at fault for 2 s" in str(held.authority.reason(held.now))


@pytest.mark.parametrize(("seconds", "kept"), [(29.9, True), (30.1, False)])
def test_rest_ends_the_lease(held: Room, seconds: float, kept: bool) -> None:
    held.drive("A", 5.0, 0.5)
    held.drive("A", seconds, 0.0)
    assert held.holder == ("A" if kept else "")
    if not kept:
        assert held.authority.reason(held.now) == IDLE


def test_a_moving_hand_keeps_the_lease_for_good(held: Room) -> None:
    for _ in range(5):
        held.drive("A", 28.0, 0.0)
        held.drive("A", 1.5, source="fault")
        held.drive("A", 0.1, 0.2)
    assert (held.holder, held.authority.counter) == ("A", FIRST)


def test_each_grant_has_another_counter_and_an_old_one_counts_nothing(held: Room) -> None:
    for turn in range(1, 5):
        held.wait(1.1)
        held.say("A" if turn % 2 == 0 else "B", 0)
        assert held.authority.counter == FIRST + turn
        held.say(held.holder, FIRST + turn - 1, 0.5)
        assert held.passes is None
        held.say(held.holder, FIRST + turn, 0.5)
        assert held.passes == 0.5


def test_a_holder_that_asks_anew_by_a_wish_gets_another_lease_once(held: Room) -> None:
    """For another hand of the same operator."""
    held.say("A", 0, 0.1)
    assert held.authority.counter == FIRST, "it has not heard yet which lease it has"
    held.say("A", FIRST)
    held.say("A", 0)
    assert held.authority.counter == FIRST, "no hand wishes to drive"
    for _ in range(3):
        held.say("A", 0, 0.1)
        assert (held.holder, held.authority.counter, held.passes) == ("A", FIRST + 1, None)
    held.say("A", FIRST, 0.3)
    assert held.passes is None
    held.say("A", FIRST + 1, 0.3)
    assert held.passes == 0.3


@pytest.mark.parametrize("first", [0, 1, (1 << 32) - 2, (1 << 32) - 1])
def test_counters_wrap_past_zero(first: int) -> None:
    room = Room(first)
    counters = []
    for _ in range(4):
        room.say("A", 0)
        counters.append(room.authority.counter)
        room.say("A", counters[-1], 0.5)
        assert room.passes == 0.5
        room.wait(1.1)
    assert len(set(counters)) == 4
    assert all(0 < counter < 1 << 32 for counter in counters)


@pytest.mark.parametrize(
    ("name", "linear", "taken"),
    [("carer", 0.5, True), ("carer", 0.0, False), ("keyboard", 0.5, False), ("child", 0.5, False)],
)
def test_a_higher_priority_takes_the_lease_by_a_wish(held: Room, name: str, linear: float, taken: bool) -> None:
    held.say("A", FIRST, 0.3)
    held.say("B", 0, linear, name=name)
    assert held.holder == ("B" if taken else "A")
    assert held.passes == (None if taken else 0.3)
    if taken:
        held.say("A", FIRST, 0.3)
        held.say("A", FIRST + 1, 0.3)
        held.say("A", 0, 0.3)
        assert (held.holder, held.passes) == ("B", None)
        held.say("B", FIRST + 1, 0.5, name=name)
        assert held.passes == 0.5


def test_whoever_ranks_below_those_that_are_not_named_is_taken_from_and_the_reason_says_how(room: Room) -> None:
    room.say("A", 0, name="child")
    reason = str(room.authority.reason(room.now))
    assert "held by child (A), which gives way to others; tilt or press a drive key" in reason
    room.say("B", 0, 0.5)
    assert room.holder == "B"
    assert "until it rests" in str(room.authority.reason(room.now))


@pytest.mark.parametrize(("name", "action"), [("joystick", "ask"), ("child", "take")])
def test_the_reason_names_who_holds_the_lease(room: Room, name: str, action: str) -> None:
    """A page has names of its own for those who drive."""
    room.say("1a2b3c4d5e", 0, name=name)
    reason = room.authority.reason(room.now)
    assert (reason.what.startswith("held by"), reason.action, reason.argument) == (True, action, name)


@pytest.mark.parametrize("program", ["motion", "script", "ros2", "patrol", "demo"])
@pytest.mark.parametrize("hand", HANDS)
def test_a_program_that_no_file_names_stands_below_a_persons_hand(room: Room, program: str, hand: str) -> None:
    room.say("A", 0, name=program)
    room.say("B", 0, 0.5, name=hand)
    assert room.holder == "B"
    room.say("A", 0, 0.5, name=program)
    assert room.holder == "B"


def test_a_name_that_no_table_has_takes_the_robot_from_a_demonstration_alone(room: Room) -> None:
    for instance, name, holder in (
        ("A", "demo", "A"),
        ("B", "patrol", "B"),
        ("C", "motion", "B"),
        ("D", "gamepad", "B"),
    ):
        room.say(instance, 0, 0.5, name=name)
        assert room.holder == holder


def test_the_names_of_askers_that_no_table_ranks_are_kept_and_told_once_with_the_line_to_write(room: Room) -> None:
    for name in ("joystick", "carer", "script", "gamepad", "motion", "ros2", "pad.2", "gamepad"):
        room.say("A", 0, name=name)
    assert room.authority.unranked == ("gamepad", "pad.2")
    assert "write `gamepad = 0` under [guard.priorities] in the robot file" in unranked_notice("gamepad").remedy
    assert '`"pad.2" = 0`' in unranked_notice("pad.2").remedy
    for number in range(100):
        room.say("A", 0, name=f"flood{number}")
    assert len(room.authority.unranked) == 8


def test_each_process_counts_its_own_commands(held: Room) -> None:
    held.say("A", FIRST, 0.5, seq=5000)
    held.say("B", 0, 0.5, name="carer", seq=3)
    held.say("B", FIRST + 1, 0.3, name="carer", seq=3)
    assert held.passes is None
    held.say("B", FIRST + 1, 0.3, name="carer", seq=4)
    assert held.passes == 0.3


def test_a_higher_priority_at_fault_or_late_takes_nothing(held: Room) -> None:
    held.say("B", 0, 0.5, name="carer", source="fault")
    held.say("B", 0, 0.5, name="carer", age=0.5)
    assert held.holder == "A"


def test_while_nobody_drives_the_reason_is_the_newest_askers(room: Room) -> None:
    assert "start giraff drive or giraff_joystick" in str(room.authority.reason(room.now))
    room.say("A", 0, age=5.0)
    assert "joystick: its command is 5.0 s old; check its link" in str(room.authority.reason(room.now))
    room.wait(1.1)
    assert "5.0 s" not in str(room.authority.reason(room.now))


def test_the_holders_late_commands_are_named(held: Room) -> None:
    held.say("A", FIRST, age=0.6)
    assert "0.6 s old; check its link" in str(held.authority.asked(held.now)[1])
    held.wait(0.9)
    held.say("A", FIRST, source="fault", age=0.6)
    assert str(held.authority.asked(held.now)[1]) == "joystick: the hand is lost"
