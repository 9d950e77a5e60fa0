"""When the robot may move: only after a held neutral hand, and never again by itself after a reset of any kind."""

from collections.abc import Callable
from itertools import pairwise

import msgspec
import pytest

from giraff_base.drive import Answer
from giraff_base.drives.wheels.drive import WheelsDrive
from giraff_schemas.messages import Side
from giraff_schemas.trouble import Trouble
from tests.unit.base.rig import EPOCH, Rig, moving


def test_a_neutral_hand_arms_and_then_the_robot_drives(rig: Rig) -> None:
    rig.run(1.0)
    assert rig.base.state().armed
    rig.tilt(0.3)
    assert rig.run(1.5)[-1].levels == (35, 35)


def test_nothing_moves_before_a_neutral_hand(rig: Rig) -> None:
    rig.tilt(0.6, 0.5)
    sent = rig.run(5.0)
    assert len(sent) > 400
    assert moving(sent) == []
    assert all("hold the hand level" in str(each.state.reason) for each in sent[10:])


def test_arming_takes_0_2_s_of_the_hands_own_time(rig: Rig) -> None:
    rig.operator_age = 0.0
    rig.run(0.02)
    first_neutral = rig.robot_ns
    while not rig.base.state().armed:
        rig.step()
    assert rig.robot_ns - first_neutral == 200_000_000


def test_a_hand_that_was_level_before_the_disarming_does_not_arm_after_it(rig: Rig) -> None:
    rig.operator_age = 0.3
    rig.run(1.0)
    assert rig.base.state().armed
    rig.board.reset()
    rig.run(0.3)  # what is on its way is still of the level hand, which tilts at the reset
    rig.tilt(0.3)
    assert moving(rig.run(1.0)) == []
    rig.tilt(0.0)
    rig.run(0.6)
    assert rig.base.state().armed


def test_one_old_neutral_command_repeated_for_ages_never_arms(rig: Rig) -> None:
    rig.freeze(5.0)
    assert not rig.base.state().armed


@pytest.mark.parametrize("age", [0.03, 0.2, 0.39])
def test_many_copies_of_one_neutral_measurement_are_one(rig: Rig, age: float) -> None:
    still = rig.ago(age)
    for _ in range(100):
        rig.say(msgspec.structs.replace(rig.command(), operator_tick=still))
    assert not rig.base.state().armed


def test_two_neutral_moments_with_silence_between_them_are_not_a_held_hand(rig: Rig) -> None:
    for _ in range(10):
        rig.guard_speaks = True
        rig.run(0.02)
        rig.guard_speaks = False
        rig.run(0.6)
    assert not rig.base.state().armed


def test_a_tilt_in_between_starts_the_time_again(rig: Rig) -> None:
    for _ in range(10):
        rig.tilt(0.0)
        rig.run(0.18)
        rig.tilt(0.3)
        rig.run(0.02)
    assert not rig.base.state().armed
    assert moving(rig.sent) == []


@pytest.mark.parametrize(
    "spoil",
    [
        lambda rig: setattr(rig, "source", "fault"),
        lambda rig: setattr(rig, "hand_neutral", False),
        lambda rig: setattr(rig, "operator_age", 0.41),
        lambda rig: setattr(rig, "operator_age", -0.01),
        lambda rig: setattr(rig, "guard_age", 0.21),
        lambda rig: setattr(rig, "guard_age", -0.01),
        lambda rig: setattr(rig, "epoch", EPOCH + 1),
    ],
    ids=["fault", "not the hand's", "stale hand", "hand ahead", "stale guard", "guard ahead", "other epoch"],
)
def test_a_neutral_that_proves_nothing_does_not_arm(rig: Rig, spoil: Callable[[Rig], None]) -> None:
    spoil(rig)
    rig.run(3.0)
    assert not rig.base.state().armed
    assert rig.base.state().reason


def test_a_guard_that_says_neutral_hand_and_drives_does_not_arm(rig: Rig) -> None:
    rig.hand_neutral = True
    rig.tilt(0.3)
    rig.run(3.0)
    assert moving(rig.sent) == []


def reopen(rig: Rig) -> None:
    rig.base.on_link_opened(session=100)


def lose(rig: Rig) -> None:
    rig.base.on_link_lost(Trouble("unplugged"))
    rig.connected = False
    rig.run(0.1)
    rig.connected = True
    reopen(rig)


def other_guard(rig: Rig) -> None:
    rig.guard_speaks = False
    rig.run(0.6)
    rig.guard_speaks, rig.guard = True, "guard-2"


def stale_operator_while_the_board_is_silent(rig: Rig) -> None:
    rig.operator_tick = rig.ago(rig.operator_age)
    rig.run(0.5)
    rig.connected = False
    rig.run(0.9)
    rig.operator_tick = None
    rig.run(0.02)
    rig.connected = True


def for_a_while(seconds: float = 0.02, **others: object) -> Callable[[Rig], None]:
    """Return what gives attributes of the rig other values for so long."""

    def happen(rig: Rig) -> None:
        usual = {name: getattr(rig, name) for name in others}
        for values, lasts in ((others, seconds), (usual, 0.0)):
            for name, value in values.items():
                setattr(rig, name, value)
            rig.run(lasts)

    return happen


fault = for_a_while(source="fault")
DISARMING: dict[str, tuple[Callable[[Rig], object], str]] = {
    "reopen": (reopen, "opened anew"),
    "lose": (lose, "link was lost"),
    "reset board": (lambda rig: rig.board.reset(), "board was reset"),
    "other operator": (lambda rig: setattr(rig, "operator", "operator-2"), "another operator"),
    "operator for a moment": (for_a_while(operator="operator-2"), "another operator"),
    "other lease": (lambda rig: setattr(rig, "lease_counter", 6), "a new lease"),
    "another program": (lambda rig: setattr(rig.board, "session", 55), "another program"),
    "silent board": (for_a_while(1.05, connected=False), "silent"),
    "other guard": (other_guard, "guard-2"),
    "second guard": (for_a_while(guard="guard-2"), "guard-2"),
    "fault": (fault, "fault"),
    "fault between two words": (lambda rig: setattr(rig, "faults", 1), "was at fault"),
    "stale operator": (lambda rig: rig.freeze(1.0), "stale"),
    "stale operator while the board is silent": (stale_operator_while_the_board_is_silent, "stale"),
    "silent guard": (for_a_while(1.02, guard_speaks=False), "stale"),
    "stale range": (for_a_while(range_age=1.01), "stale"),
    "no operator tick": (for_a_while(operator_age=-1.0), "stale"),
}


@pytest.mark.parametrize("name", DISARMING)
def test_what_disarms_while_driving(name: str) -> None:
    happen, why = DISARMING[name]
    rig = Rig()
    rig.drive(0.6)
    happen(rig)
    before = len(rig.sent)
    rig.run(3.0)
    after = rig.sent[before:]
    assert not rig.base.state().armed
    assert moving(after[2:]) == []
    assert str(after[-1].state.reason).startswith("not armed since")
    assert why in str(after[-1].state.reason)
    assert "hold the hand level for 0.2 s" in str(after[-1].state.reason)
    rig.arm()
    rig.tilt(0.6)
    again = rig.run(1.5)
    assert again[-1].levels == (70, 70)
    assert max(each.levels[0] for each in again[:5]) < 10


@pytest.mark.parametrize("name", DISARMING)
def test_what_disarms_a_robot_that_stands(name: str) -> None:
    happen, why = DISARMING[name]
    rig = Rig()
    rig.arm()
    # A range counts for what is driven; everything else is refused for what it is.
    rig.tilt(0.6 if name == "stale range" else 0.0)
    happen(rig)
    rig.tilt(0.6)
    sent = rig.run(3.0)
    assert moving(sent) == []
    assert why in str(sent[-1].state.reason)


@pytest.mark.parametrize(
    ("stop", "resume"),
    [
        (
            lambda rig: setattr(rig, "operator_tick", rig.ago(rig.operator_age)),
            lambda rig: setattr(rig, "operator_tick", None),
        ),
        (lambda rig: setattr(rig, "guard_speaks", False), lambda rig: setattr(rig, "guard_speaks", True)),
        (lambda rig: setattr(rig, "range_age", 0.9), lambda rig: setattr(rig, "range_age", 0.1)),
    ],
    ids=["operator", "guard", "range"],
)
def test_shorter_staleness_stops_and_the_ramp_starts_again(
    rig: Rig, stop: Callable[[Rig], None], resume: Callable[[Rig], None]
) -> None:
    rig.drive(0.6)
    stop(rig)
    rig.run(0.8)
    assert not rig.sent[-1].moves
    assert rig.sent[-1].state.reason
    resume(rig)
    again = rig.run(1.5)
    assert rig.base.state().armed
    starts = [each.levels[0] for each in moving(again)]
    assert starts[0] <= 1
    assert all(after - before <= 1 for before, after in pairwise(starts))
    assert starts[-1] == 70


def test_a_dead_range_leaves_turning(driven: Rig) -> None:
    driven.range_age = None
    driven.tilt(0.0, 1.0)
    assert driven.run(1.5)[-1].levels == (-27, 27)


def test_the_reason_to_be_unarmed_is_the_first_one_since_it_was_armed(driven: Rig) -> None:
    reopen(driven)
    driven.run(0.1)
    fault(driven)
    driven.run(1.0)
    assert "opened anew" in str(driven.base.state().reason)


def test_starting_is_a_reason_too(rig: Rig) -> None:
    rig.tilt(0.1)
    rig.run(1.0)
    assert "base has just started" in str(rig.base.state().reason)


def test_what_a_drive_forbids_disarms_until_it_is_put_right(rig: Rig, monkeypatch: pytest.MonkeyPatch) -> None:
    rig.drive(0.3)
    lies = Trouble("the robot is off and not upright", "hold it upright and still")
    monkeypatch.setattr(WheelsDrive, "arming_block", lies)
    assert moving(rig.run(0.5)) == []
    rig.tilt(0.0)
    rig.run(0.6)
    assert (rig.base.state().armed, rig.base.reason) == (False, lies)
    monkeypatch.setattr(WheelsDrive, "arming_block", Trouble())
    rig.arm()


def test_what_a_drive_notices_is_told_and_stops_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    rig, rolls = Rig(), Trouble("the wheels turn without power")
    monkeypatch.setattr(WheelsDrive, "warning", rolls)
    rig.drive(0.3)
    assert moving(rig.run(0.5)) != []
    assert rig.base.faults["rolling"] == rolls


def test_the_side_to_sit_down_to_is_as_old_as_its_guard(monkeypatch: pytest.MonkeyPatch) -> None:
    rig, told, ask = Rig(), [], WheelsDrive.ask

    def heard(self: WheelsDrive, linear: float, angular: float, *, armed: bool, free_side: Side) -> Answer:
        told.append((armed, free_side))
        return ask(self, linear, angular, armed=armed, free_side=free_side)

    monkeypatch.setattr(WheelsDrive, "ask", heard)
    rig.run(0.1)
    assert told[-1] == (False, "none")
    rig.arm()
    rig.say(msgspec.structs.replace(rig.command(), free_side="forward"))
    rig.guard_speaks = False
    rig.run(0.1)
    assert told[-1] == (True, "forward")
    rig.run(0.2)
    assert told[-1] == (True, "none")
