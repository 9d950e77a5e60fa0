"""The emergency stop in base: it stops with the next frame, and only a fresh reset of this very latch permits again."""

import msgspec
import pytest

from giraff_base.estop import EStopControl, EStopLatch
from giraff_core.estop.latch import SEE_THAT_IT_MAY
from giraff_schemas.actions import ANY, Action
from giraff_schemas.messages import RobotTime
from giraff_schemas.requests import EStopAnswer, EStopEngage, EStopReset
from giraff_schemas.trouble import Trouble
from giraff_schemas.wire import ConfigureFrame, DriveFrame, DriveState, EstopFrame, Latch
from tests.unit.base.rig import EPOCH, Rig, moving

ENGAGED = EStopLatch(engaged=True, id=7, by="keyboard", reason=Trouble("space bar", SEE_THAT_IT_MAY, "release"))
TO_RELEASE = ENGAGED.reason.to_do(ANY)


def engage(rig: Rig, by: str = "keyboard", reason: str = "space bar") -> EStopAnswer:
    return rig.base.on_engage(EStopEngage(by=by, reason=Trouble(reason)), rig.now)


def reset(rig: Rig, age: float = 0.0, id_error: int = 0) -> EStopAnswer:
    tick = rig.ago(age)
    return rig.base.on_reset(EStopReset(by="carer", id=rig.base.latch.id + id_error, tick=tick), rig.now)


def test_engaging_stops_with_the_next_frame_and_latches_the_board(driven: Rig) -> None:
    answer = engage(driven)
    assert (answer.done, answer.engaged, answer.id) == (True, True, driven.base.latch.id)
    assert not driven.base.state().armed
    assert not driven.base.state().driving
    # At once, though the newest report of the board has been answered with motion.
    frame = driven.base.next_frame(driven.now)
    assert isinstance(frame, EstopFrame)
    assert frame.engage == 1
    driven.board.receive(frame)
    assert driven.board.levels == (0, 0)
    assert moving(driven.run(3.0)) == []
    assert driven.base.state().board.latch == "estop"


def test_all_frames_of_an_engaged_base_are_zero_whatever_the_board_says(driven: Rig) -> None:
    engage(driven)
    for latch, state in ((Latch.ESTOP, DriveState.LATCHED), (Latch.ESTOP, DriveState.ACTIVE)):
        driven.board.latch, driven.board.drive_state = latch, state
        driven.base.on_frames([driven.board.report()], driven.now)
        frame = driven.base.next_frame(driven.now)
        assert isinstance(frame, DriveFrame)
        assert (frame.left_level, frame.right_level) == (0, 0)


def test_the_order_to_latch_is_repeated_until_the_board_has_it(driven: Rig) -> None:
    driven.board.is_deaf = True
    engage(driven)
    assert all(isinstance(frame, EstopFrame) and frame.engage for frame in (driven.step() for _ in range(50)))
    driven.board.is_deaf = False
    driven.run(0.05)
    assert driven.board.latch == Latch.ESTOP


@pytest.mark.parametrize("ignores", [True, False])
def test_a_board_is_latched_before_it_is_configured(ignores: bool) -> None:
    rig = Rig(latch=ENGAGED)
    rig.board.ignores_configure = ignores
    first = rig.step()
    assert isinstance(first, EstopFrame)
    assert rig.board.latch == Latch.ESTOP
    assert isinstance(rig.step(), ConfigureFrame)


def test_base_that_starts_engaged_stays_so_and_says_by_whom() -> None:
    rig = Rig(latch=ENGAGED)
    rig.tilt(0.0)
    rig.run(1.0)
    rig.tilt(0.6)
    assert moving(rig.run(2.0)) == []
    assert str(rig.base.state().reason) == f"emergency stop by keyboard: space bar; {TO_RELEASE}"
    sample = rig.base.estop()
    assert (sample.engaged, sample.id, sample.by) == (True, 7, "keyboard")
    assert sample.reason == ENGAGED.reason == msgspec.structs.replace(rig.base.state().reason, what="space bar")


def test_a_reset_permits_motion_and_never_causes_it(driven: Rig) -> None:
    engage(driven)
    driven.run(0.5)
    answer = reset(driven)
    assert (answer.done, answer.engaged, str(answer.reason)) == (True, False, "")
    assert moving(driven.run(2.0)) == []
    assert driven.board.latch == Latch.NONE
    assert str(driven.base.state().reason) == "not armed since the emergency stop; hold the hand level for 0.2 s"
    driven.drive(0.6)


def test_neutral_held_while_engaged_arms_nothing(driven: Rig) -> None:
    engage(driven)
    driven.tilt(0.0)
    driven.run(2.0)
    assert not driven.base.state().armed
    reset(driven)
    driven.tilt(0.6)
    assert moving(driven.run(2.0)) == []


@pytest.mark.parametrize(
    ("age", "is_done"), [(0.0, True), (0.999, True), (1.0, True), (1.001, False), (8.0, False), (-0.1, False)]
)
def test_a_reset_counts_only_while_it_is_fresh(driven: Rig, age: float, is_done: bool) -> None:
    engage(driven)
    driven.run(1.5)
    answer = reset(driven, age)
    assert (answer.done, driven.base.latch.engaged, answer.engaged) == (is_done, not is_done, not is_done)
    assert ("1 s" in str(answer.reason)) != is_done


@pytest.mark.parametrize("tick", [None, RobotTime(epoch=EPOCH + 1, robot_ns=0), RobotTime(epoch=0, robot_ns=0)])
def test_a_reset_that_has_not_heard_base_clears_nothing(rig: Rig, tick: RobotTime | None) -> None:
    engage(rig)
    if tick is not None:
        tick = msgspec.structs.replace(tick, robot_ns=rig.robot_ns)
    answer = rig.base.on_reset(EStopReset(by="carer", id=rig.base.latch.id, tick=tick), rig.now)
    assert not answer.done
    assert rig.base.latch.engaged


@pytest.mark.parametrize("error", [-1, 1, 1000])
def test_a_reset_of_another_latch_clears_nothing_and_is_told_of_the_one_there(rig: Rig, error: int) -> None:
    engage(rig)
    answer = reset(rig, id_error=error)
    assert (answer.done, answer.engaged, answer.id) == (False, True, rig.base.latch.id)
    assert f"latch {rig.base.latch.id} by keyboard" in str(answer.reason)


def test_a_reset_replayed_8_s_late_clears_nothing_newer_and_nothing_moves(driven: Rig) -> None:
    engage(driven)
    driven.run(0.5)
    replayed = EStopReset(by="carer", id=driven.base.latch.id, tick=driven.ago(0.1))
    assert driven.base.on_reset(replayed, driven.now).done
    driven.run(0.5)
    engage(driven)
    driven.run(8.0)
    assert not driven.base.on_reset(replayed, driven.now).done
    # Not even under the number of the newer one.
    assert not driven.base.on_reset(msgspec.structs.replace(replayed, id=driven.base.latch.id), driven.now).done
    assert driven.base.latch.engaged
    assert moving(driven.run(1.0)) == []


def test_repeating_a_reset_or_an_engaging_that_was_done_changes_nothing(rig: Rig) -> None:
    first, again = engage(rig), engage(rig)
    assert first == again
    request = EStopReset(by="carer", id=first.id, tick=rig.now)
    done = rig.base.on_reset(request, rig.now)
    rig.run(0.1)
    rig.drive(0.6)
    assert rig.base.on_reset(request, rig.now) == done
    assert rig.base.state().armed
    assert rig.run(0.1)[-1].moves


def test_a_reset_from_before_the_newest_engaging_clears_nothing_even_of_the_same_latch(rig: Rig) -> None:
    engage(rig)
    rig.run(0.5)
    pressed = EStopReset(by="carer", id=rig.base.latch.id, tick=rig.now)
    rig.run(0.2)
    again = engage(rig)
    assert (again.done, again.id) == (True, pressed.id)
    rig.run(0.1)
    answer = rig.base.on_reset(pressed, rig.now)
    assert (answer.done, answer.engaged) == (False, True)
    assert "engaged again after this reset was asked for; ask again" in str(answer.reason)
    assert reset(rig).done


def test_a_stop_that_was_asked_for_again_since_it_was_seen_is_not_cleared_though_the_wish_is_newer(rig: Rig) -> None:
    engage(rig)
    seen = rig.base.estop()
    rig.run(1.0)
    again = engage(rig)
    assert (again.done, again.id) == (True, seen.id)
    rig.run(0.1)
    wish = EStopReset(by="carer", id=seen.id, tick=rig.now, engaged_ns=seen.engaged_ns)
    answer = rig.base.on_reset(wish, rig.now)
    assert (answer.done, answer.engaged) == (False, True)
    assert "engaged again" in str(answer.reason)
    newest = msgspec.structs.replace(wish, engaged_ns=rig.base.estop().engaged_ns)
    assert rig.base.on_reset(newest, rig.now).done


def test_each_cause_is_a_latch_of_its_own_that_a_reset_of_the_one_before_leaves(rig: Rig) -> None:
    first = engage(rig)
    assert engage(rig, by="giraff estop").id != first.id
    answer = rig.base.on_reset(EStopReset(by="carer", id=first.id, tick=rig.ago(0.1)), rig.now)
    assert not answer.done
    assert "by giraff estop" in str(answer.reason)
    assert rig.base.latch.engaged
    reset(rig)
    assert engage(rig).id not in (first.id, first.id + 1)


def test_what_others_write_into_the_latch_is_cut(rig: Rig) -> None:
    engage(rig, by="x" * 1_000_000, reason="y" * 1_000_000)
    assert len(rig.base.latch.by) == 200
    assert len(str(rig.base.latch.reason)) < 300
    assert rig.base.latch.reason.action == "release"


ODD = "a\x1b[2Jb\nc\x9bd\u202ee\udcc3"
PLAIN = "a?[2Jb?c?d?e?"


def test_what_others_write_into_the_latch_steers_no_terminal(rig: Rig) -> None:
    engage(rig, by=ODD, reason=ODD)
    told = rig.base.estop()
    assert (told.by, str(told.reason)) == (PLAIN, f"{PLAIN}; {TO_RELEASE}")
    assert str(rig.base.reason).isprintable()
    rows: tuple[tuple[Action, str], ...] = (
        ("release", PLAIN),
        ("run", PLAIN),
        ("", ""),
        ("hold_level", ""),
        ("ask", ""),
    )
    for action, argument in rows:
        edited = EStopLatch(engaged=True, id=1, by=ODD, reason=Trouble(ODD, ODD, action, ODD))
        shown = EStopControl(edited, 1.0, can_power_off=False).latch
        assert (shown.by, shown.reason) == (PLAIN, Trouble(PLAIN, PLAIN, "release", argument)), action
    rig.base.on_reset(EStopReset(by=ODD, id=rig.base.latch.id, tick=rig.ago(0.0)), rig.now)
    assert (rig.base.latch.engaged, rig.base.latch.by) == (False, PLAIN)


@pytest.mark.parametrize(
    ("latch", "words"),
    [
        (Latch.ESTOP, ("kept an emergency stop",)),
        (Latch.LEFT_STUCK, ("left wheel stuck", "free it", "encoder")),
        (Latch.RIGHT_STUCK, ("right wheel stuck", "free it", "encoder")),
        (Latch.LEFT_OPPOSITE, ("left wheel turned against", "giraff check wheels")),
        (Latch.RIGHT_OPPOSITE, ("right wheel turned against", "giraff check wheels")),
    ],
)
def test_a_latch_of_the_board_becomes_bases_own(driven: Rig, latch: Latch, words: tuple[str, ...]) -> None:
    driven.board.engage(latch)
    assert moving(driven.run(2.0)) == []
    state = driven.base.state()
    assert not state.armed
    assert state.board.latch == latch.name.lower()
    assert driven.base.latch.engaged
    assert driven.base.latch.by == "the base board"
    assert all(word in str(state.reason) for word in words)
    assert state.reason.action == "release"
    assert driven.board.latch == latch  # base does not paint it over with its own
    assert reset(driven).done
    driven.run(0.1)
    assert driven.board.latch == Latch.NONE
    driven.drive(0.6)


def test_a_latch_that_no_header_knows_stops_too(driven: Rig) -> None:
    driven.base.on_frames(
        [msgspec.structs.replace(driven.board.report(), latch=77, drive_state=88, last_refusal=99)], driven.now
    )
    assert driven.base.latch.engaged
    assert driven.base.state().board.latch == "unknown 77"
    assert driven.base.state().board.last_refusal == "unknown 99"


def test_a_board_that_latches_again_after_its_release_stops_again(driven: Rig) -> None:
    driven.board.engage(Latch.LEFT_STUCK)
    driven.run(0.1)
    first = driven.base.latch.id
    reset(driven)
    driven.run(0.1)
    assert driven.board.latch == Latch.NONE
    driven.board.engage(Latch.LEFT_STUCK)
    driven.run(0.1)
    assert driven.base.latch.engaged
    assert driven.base.latch.id != first


def test_a_release_is_repeated_until_the_board_has_it_and_then_never(rig: Rig) -> None:
    engage(rig)
    rig.run(0.2)
    rig.board.is_deaf = True
    reset(rig)
    frames = [rig.step() for _ in range(20)]
    assert all(isinstance(frame, EstopFrame) and not frame.engage for frame in frames)
    assert "released" in str(rig.base.state().reason)
    rig.board.is_deaf = False
    rig.run(0.1)
    assert rig.board.latch == Latch.NONE
    assert all(isinstance(rig.step(), DriveFrame) for _ in range(20))


@pytest.mark.parametrize("break_off", ["open", "lose", "reboot"])
def test_a_release_is_of_the_board_there_was_when_it_was_asked_for(rig: Rig, break_off: str) -> None:
    engage(rig)
    rig.run(0.2)
    rig.connected = False
    reset(rig)
    if break_off == "reboot":
        rig.board.reset()
    elif break_off == "lose":
        rig.base.on_link_lost(Trouble("unplugged"))
    else:
        rig.base.on_link_opened(session=100)
    rig.board.engage(Latch.LEFT_STUCK)
    rig.connected = True
    rig.run(0.5)
    assert rig.board.latch == Latch.LEFT_STUCK
    assert rig.base.latch.engaged


def test_without_a_board_engaging_and_resetting_work(rig: Rig) -> None:
    rig.connected = False
    rig.base.on_link_lost(Trouble("the port is gone", "plug it in"))
    engage(rig)
    assert str(rig.base.state().reason).startswith("emergency stop by keyboard")
    assert rig.base.next_frame(rig.now) is None
    assert reset(rig).done
    assert str(rig.base.state().reason) == "the port is gone; plug it in"


def test_an_engaging_takes_back_a_release_under_way(rig: Rig) -> None:
    engage(rig)
    rig.run(0.2)
    rig.board.is_deaf = True
    reset(rig)
    rig.run(0.05)
    engage(rig)
    rig.board.is_deaf = False
    frames = [rig.step() for _ in range(100)]
    assert not any(isinstance(frame, EstopFrame) for frame in frames)  # it never was released
    assert rig.board.latch == Latch.ESTOP
    assert rig.base.latch.engaged
