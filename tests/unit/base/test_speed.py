"""Base and a board that holds speeds: what is asked of it, a wheel that is held, and one at its limit."""

from itertools import pairwise

import msgspec
import pytest

from giraff_base.drives.wheels.config import WheelsConfig
from giraff_base.drives.wheels.words import limit
from giraff_schemas.boards import ARDROS_BOARD, BASE_BOARD
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_schemas.wire import DriveFrame, DriveState, Frame, SpeedFlag, SpeedFrame
from tests.support.robots import BY_SPEED, DRIVE
from tests.unit.base.rig import CONFIG, ROBOT, Board, Rig, moving

FULL_UM_S = 600_000
HELD = [
    (SpeedFlag.LEFT_HELD, "the left wheel was held"),
    (SpeedFlag.RIGHT_HELD, "the right wheel was held"),
    (SpeedFlag.LEFT_HELD | SpeedFlag.RIGHT_HELD, "both wheels were held"),
    (SpeedFlag(0), "a wheel was held"),
    (SpeedFlag.LEFT_HELD | SpeedFlag.AT_LIMIT, "the left wheel was held"),
]
REMEDY = "clear the way, or check its encoder, motor and battery"


@pytest.fixture
def at_speed() -> Rig:
    rig = Rig(drive=BY_SPEED)
    rig.drive(0.6)
    return rig


def test_the_board_is_told_what_it_needs_to_hold_a_speed(at_speed: Rig) -> None:
    asked = at_speed.board.configured[0]
    assert (asked.session, asked.boot_id) == (99, 1)
    # 0.6 m/s² and 2.5 rad/s² at half the track, at once.
    expected = BY_SPEED.board_settings(ROBOT, 0.6 + 2.5 * 0.235)
    assert msgspec.structs.replace(asked, seq=0, boot_id=0, board_ms=0, session=0) == expected


def test_the_board_lets_a_wheel_start_as_fast_as_base_does() -> None:
    rig = Rig(drive=BY_SPEED)
    rig.arm()
    rig.tilt(0.6, 1.0)
    steps = [after.um_s[1] - before.um_s[1] for before, after in pairwise(rig.run(0.3))]
    per_report = rig.board.configured[0].acceleration_um_s2 // 100
    assert per_report - 1 <= max(steps) <= per_report + 1


def test_starts_are_ramped_and_stops_are_not(at_speed: Rig) -> None:
    start = [each.um_s for each in moving(at_speed.sent)]
    assert all(left == right for left, right in start)
    assert start.index((FULL_UM_S, FULL_UM_S)) == pytest.approx(100, abs=4)  # 0.6 m/s at 0.6 m/s²
    at_speed.tilt(0.0)
    assert at_speed.run(0.03)[-1].um_s == (0, 0)
    at_speed.tilt(0.0, 1.0)
    assert at_speed.run(1.0)[-1].um_s == (-235_000, 235_000)


@pytest.mark.parametrize(("drive", "kind"), [(BY_SPEED, SpeedFrame), (DRIVE, DriveFrame)])
def test_each_robot_gets_frames_of_one_kind(drive: WheelsConfig, kind: type[Frame]) -> None:
    rig = Rig(drive=drive)
    rig.drive(0.6, 0.5)
    rig.guard_speaks = False
    rig.run(0.5)
    assert {type(each.frame) for each in rig.sent} == {kind}
    assert not rig.sent[-1].moves
    assert rig.base.state().board.refused == 0


def test_driving_is_that_a_wheel_is_asked_to_turn() -> None:
    rig = Rig(drive=BY_SPEED)
    rig.arm()
    assert not rig.base.state().driving
    rig.tilt(0.004)  # slower than anything can tell from standing
    assert rig.run(1.0)[-1].um_s == (0, 0)
    assert not rig.base.state().driving
    rig.tilt(0.006)
    assert rig.run(1.0)[-1].um_s == (6000, 6000)
    assert rig.base.state().driving


@pytest.mark.parametrize(("wheels", "why"), HELD)
def test_a_held_wheel_does_not_resume_by_itself(at_speed: Rig, wheels: SpeedFlag, why: str) -> None:
    at_speed.board.hold(wheels)
    sent = at_speed.run(3.0)  # the hand asks to drive all the time
    assert moving(sent) == []
    assert not sent[0].state.armed
    assert sent[0].state.board.drive_state == "held"
    reason = Trouble(f"not armed since {why}", REMEDY, "hold_level", "0.2 s")
    assert {each.state.reason for each in sent} == {reason}
    # The board has opened for the zero frame, and that changes nothing.
    assert at_speed.board.drive_state == DriveState.ACTIVE
    at_speed.tilt(0.0)
    at_speed.run(0.15)
    at_speed.tilt(0.6)
    assert moving(at_speed.run(1.0)) == []
    at_speed.tilt(0.0)
    at_speed.run(0.4)
    assert at_speed.base.state().armed
    at_speed.tilt(0.6)
    again = at_speed.run(1.5)
    assert again[-1].um_s == (FULL_UM_S, FULL_UM_S)
    assert moving(again)[0].um_s[0] < 20_000  # from rest


def test_a_held_wheel_counts_where_newer_reports_hide_it(at_speed: Rig) -> None:
    """Of many reports at once base answers the newest, and passes over none."""
    before = at_speed.board.report()
    held = msgspec.structs.replace(before, drive_state=DriveState.HELD, speed_flags=SpeedFlag.LEFT_HELD)
    at_speed.base.on_frames([before, held, before], at_speed.now)
    assert not at_speed.base.state().armed
    assert moving(at_speed.run(1.0)) == []


def test_a_flag_that_stays_after_the_hold_disarms_nobody(at_speed: Rig) -> None:
    at_speed.board.hold(SpeedFlag.LEFT_HELD)
    at_speed.run(0.1)
    at_speed.drive(0.6)
    assert at_speed.board.speed_flags == SpeedFlag.LEFT_HELD
    assert str(at_speed.base.state().reason) == ""


def test_a_wheel_at_its_limit_is_named_and_drives_on(at_speed: Rig) -> None:
    at_speed.board.speed_flags = SpeedFlag.AT_LIMIT
    sent = at_speed.run(1.0)
    assert {each.um_s for each in sent} == {(FULL_UM_S, FULL_UM_S)}
    state = sent[0].state
    assert (state.armed, state.driving) == (True, True)
    assert str(state.reason) == "at its limit: the wheels cannot do what is asked; the battery may be low"
    at_speed.board.speed_flags = SpeedFlag(0)
    assert at_speed.run(0.01)[-1].state.reason == NO_TROUBLE


def test_a_board_with_a_potentiometer_may_be_at_its_limit_by_that() -> None:
    report = msgspec.structs.replace(Board().report(), speed_flags=SpeedFlag.AT_LIMIT)
    assert str(limit(report, ARDROS_BOARD)) == f"{limit(report, BASE_BOARD)}, or the potentiometer turned down"


def test_a_limit_is_named_after_all_else_and_of_a_robot_that_drives(at_speed: Rig) -> None:
    at_speed.board.speed_flags = SpeedFlag.AT_LIMIT
    at_speed.reason = "slowed: front sees something at 0.90 m"
    at_speed.run(0.04)
    assert str(at_speed.base.state().reason) == str(at_speed.reason)
    at_speed.reason = ""
    at_speed.tilt(0.0)
    at_speed.run(0.04)
    assert at_speed.base.state().reason == NO_TROUBLE
    at_speed.run(CONFIG.arm_time)
    at_speed.source = "fault"
    at_speed.run(0.04)
    assert str(at_speed.base.state().reason) == "the operator's side reports a fault"
