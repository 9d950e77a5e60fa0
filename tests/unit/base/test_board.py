"""Base and its board: configuration, echoes, and what base says about it."""

from itertools import pairwise

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from giraff_base.drives.wheels import config as wheels_config
from giraff_base.drives.wheels.drive import WheelsDrive
from giraff_schemas.boards import BASE_BOARD
from giraff_schemas.messages import Wheels
from giraff_schemas.trouble import Trouble
from giraff_schemas.wire import (
    PROTOCOL_HASH,
    WHEELS_PERIOD_MS,
    ConfigureFrame,
    DriveFrame,
    DriveState,
    HelloFrame,
    Refusal,
    Wiring,
)
from tests.support.robots import DRIVE
from tests.unit.base.rig import CONFIG, ROBOT, Rig, moving


def test_base_tells_how_often_its_board_reports(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(wheels_config, "boards_chosen_in", lambda _: {"base": BASE_BOARD._replace(report_ms=15)})
    assert Rig().base.state().board.report_ms == 15


def test_a_board_without_our_session_is_configured_until_it_has_it() -> None:
    rig = Rig(drive=msgspec.structs.replace(DRIVE, swap_motors=True, invert_right_encoder=True, max_level=50))
    rig.board.ignores_configure = True
    frames = [frame for _ in range(100) if (frame := rig.step()) is not None]
    assert all(isinstance(frame, ConfigureFrame) for frame in frames)
    assert 18 <= len(frames) <= 21  # each 50 ms
    assert "configured" in str(rig.base.state().reason)
    rig.board.ignores_configure = False
    rig.run(0.2)
    assert len(rig.board.configured) == 1
    asked = rig.board.configured[0]
    assert asked.protocol_hash == PROTOCOL_HASH
    assert asked.session == 99
    assert asked.boot_id == 1
    assert Wiring(asked.wiring) == Wiring.SWAP_MOTORS | Wiring.INVERT_RIGHT_ENCODER
    assert asked.level_max == 50
    assert rig.board.drive_state == DriveState.ACTIVE


def test_each_configure_frame_echoes_the_newest_board_time(rig: Rig) -> None:
    rig.board.ignores_configure = True
    for _ in range(20):
        frame = rig.step()
        if isinstance(frame, ConfigureFrame):
            assert frame.board_ms == rig.board.board_ms


def test_a_board_that_refuses_our_protocol_is_named_with_the_way_out(rig: Rig) -> None:
    rig.board.protocol_hash = PROTOCOL_HASH ^ 1
    rig.tilt(0.6)
    assert rig.run(2.0) == []
    assert "reflash" in str(rig.base.state().reason)
    assert rig.board.levels == (0, 0)


def test_a_reset_board_is_configured_again_with_the_same_session(rig: Rig) -> None:
    rig.drive(0.3)
    rig.board.reset()
    rig.run(0.1)
    assert [frame.session for frame in rig.board.configured] == [99, 99]
    assert [frame.boot_id for frame in rig.board.configured] == [1, 2]
    assert rig.base.state().board.boot_id == 2


def test_a_link_that_was_opened_again_has_a_session_of_its_own(rig: Rig) -> None:
    rig.drive(0.3)
    rig.base.on_link_opened(session=100)
    assert rig.base.state().reason
    assert not rig.base.state().driving
    rig.run(0.1)
    assert rig.board.session == 100


@pytest.mark.parametrize("state", [DriveState.NOT_CONFIGURED, DriveState.AWAITING_ZERO, DriveState.COMMAND_TIMEOUT])
def test_a_latched_board_gets_zero_frames_until_it_is_active_and_then_a_ramp(driven: Rig, state: DriveState) -> None:
    driven.board.is_deaf = True
    driven.board.drive_state, driven.board.levels = state, (0, 0)
    sent = driven.run(0.5)
    assert len(sent) == 50
    assert moving(sent) == []
    assert state.name.lower() in str(sent[-1].state.reason)
    assert not sent[-1].state.driving
    driven.board.is_deaf = False
    again = driven.run(1.5)
    speeds = [each.levels[0] for each in again]
    assert speeds[0] == 0
    assert max(after - before for before, after in pairwise(speeds)) <= 1
    assert speeds[-1] == 70


def test_a_board_that_timed_out_is_driven_again_from_rest_without_arming(driven: Rig) -> None:
    driven.connected = False
    driven.run(0.4)
    assert driven.board.drive_state == DriveState.COMMAND_TIMEOUT
    driven.connected = True
    again = driven.run(1.5)
    assert [each.moves for each in again[:2]] == [False, True]
    assert again[1].levels == (1, 1)
    assert again[-1].levels == (70, 70)


def test_each_report_is_answered_once_with_its_own_echo(rig: Rig) -> None:
    for each in rig.drive(0.6, 0.5):
        assert each.frame.board_ms == each.report.board_ms
        assert each.frame.boot_id == each.report.boot_id
    assert rig.base.next_frame(rig.now) is None


def test_of_many_reports_at_once_only_the_newest_is_answered(driven: Rig) -> None:
    reports = [driven.board.report() for _ in range(80)]
    told = [sample.board_us for sample in driven.base.on_frames(reports, driven.now) if isinstance(sample, Wheels)]
    assert told == [report.board_us for report in reports]
    frame = driven.base.next_frame(driven.now)
    assert isinstance(frame, DriveFrame)
    assert frame.board_ms == reports[-1].board_ms
    assert driven.base.next_frame(driven.now) is None


def test_a_new_command_goes_down_at_once(driven: Rig) -> None:
    driven.linear = 0.0
    driven.say(driven.command())
    frame = driven.base.next_frame(driven.now)
    assert isinstance(frame, DriveFrame)
    assert (frame.left_level, frame.right_level) == (0, 0)
    assert driven.base.next_frame(driven.now) is None


def test_a_command_that_does_not_count_has_no_frame(driven: Rig) -> None:
    for refused in (
        msgspec.structs.replace(driven.command(), guard_tick=driven.ago(0.3)),
        msgspec.structs.replace(driven.command(), instance="another guard"),
        msgspec.structs.replace(driven.command(), seq=0),
    ):
        driven.say(refused)
        assert driven.base.next_frame(driven.now) is None


def test_between_two_reports_only_one_command_has_a_frame_of_its_own(driven: Rig) -> None:
    """A flood of commands does not fill the line; the newest goes down with the next report."""
    frames = []
    for number in range(50):
        driven.linear = 0.6 if number < 49 else 0.0
        driven.say(driven.command())
        frames.append(driven.base.next_frame(driven.now))
    assert [frame is not None for frame in frames] == [True] + [False] * 49
    driven.base.on_frames([driven.board.report()], driven.now)
    answer = driven.base.next_frame(driven.now)
    assert isinstance(answer, DriveFrame)
    assert (answer.left_level, answer.right_level) == (0, 0)


def test_a_frame_between_two_reports_does_not_hasten_a_start() -> None:
    """The ramp goes by time, not by frames."""
    plain, hurried = Rig(), Rig()
    for rig in (plain, hurried):
        rig.arm()
        rig.linear = 0.6
    for _ in range(40):
        plain.step()
        hurried.step()
        hurried.robot_ns += 5_000_000
        hurried.say(hurried.command())
        frame = hurried.base.next_frame(hurried.now)
        hurried.robot_ns -= 5_000_000
        assert isinstance(frame, DriveFrame)
    assert 0 < hurried.board.levels[0] <= plain.board.levels[0] + 1


def test_without_a_report_there_is_nothing_to_send(driven: Rig) -> None:
    """But once: the board refuses what echoes an old report."""
    frames = []
    for _ in range(10):
        driven.robot_ns += 10_000_000
        driven.say(driven.command())
        frames.append(driven.base.next_frame(driven.now))
    assert [frame is not None for frame in frames] == [True] + [False] * 9
    driven.base.on_link_lost(Trouble("unplugged"))
    driven.say(driven.command())
    assert driven.base.next_frame(driven.now) is None


def test_sequence_goes_on_across_its_wrap_and_the_board_takes_every_frame(rig: Rig) -> None:
    assert isinstance(rig.base._drive, WheelsDrive)
    rig.base._drive._frames._seq = 0xFF80
    sent = rig.drive(0.3)
    seqs = [each.frame.seq for each in sent]
    assert 0xFFFF in seqs
    assert 0 in seqs
    assert all((after - before) & 0xFFFF == 1 for before, after in pairwise(seqs))
    assert rig.base.state().board.refused == 0
    assert rig.board.drive_state == DriveState.ACTIVE


def test_the_boards_clock_wraps_without_a_trace(rig: Rig) -> None:
    sent = rig.drive(0.3) + rig.run(2.0)
    assert any(before.report.board_us > after.report.board_us for before, after in pairwise(sent))
    steady = sent[200:]
    assert {each.levels for each in steady} == {(35, 35)}
    assert all(sample.left_velocity == pytest.approx(0.3, abs=0.02) for sample in rig.samples[-100:])


def test_starts_are_ramped_and_stops_are_not(armed: Rig) -> None:
    armed.tilt(0.6)
    speeds = [each.levels[0] for each in armed.run(1.2)]
    assert speeds.index(70) == pytest.approx(100, abs=4)  # 0.6 m/s at 0.6 m/s²
    armed.tilt(0.0)
    assert armed.run(0.03)[-1].levels == (0, 0)
    armed.tilt(0.0, 1.0)
    turns = [each.levels[1] for each in armed.run(1.0)]
    assert turns.index(27) == pytest.approx(40, abs=4)  # 1 rad/s at 2.5 rad/s²


@pytest.mark.parametrize("ends", ["travel", "turn"])
def test_the_one_that_goes_on_does_not_leap_where_the_other_ends(armed: Rig, ends: str) -> None:
    """Both are slowed where a wheel would be too fast; the one left alone may be faster, by its ramp."""
    armed.tilt(0.6, 2.0)
    armed.run(1.5)
    left, right = armed.sent[-1].levels
    assert max(left, right) == DRIVE.max_level
    if ends == "travel":
        armed.tilt(0.0, 2.0)
        before, step = (right - left) / 2, CONFIG.angular_acceleration * ROBOT.track_width / 2
    else:
        armed.tilt(0.6, 0.0)
        before, step = (right + left) / 2, CONFIG.linear_acceleration
    step *= WHEELS_PERIOD_MS * 1e-3 * DRIVE.max_level / ROBOT.max_wheel_speed
    alone = [each.levels[1] for each in armed.run(0.5) if abs(each.levels[0]) == abs(each.levels[1])]
    assert alone[0] <= before + 2 * step + 1, "the guard speaks each second report"
    assert all(after <= now + step + 1 for now, after in pairwise(alone))
    assert alone[-1] > before + 10


def test_a_reversal_starts_from_zero(driven: Rig) -> None:
    driven.tilt(-0.6)
    speeds = [each.levels[0] for each in driven.run(1.2)]
    turn = next(n for n, speed in enumerate(speeds) if speed <= 0)
    assert all(speed == 70 for speed in speeds[:turn])
    assert speeds[turn] >= -1
    assert all(after - before >= -1 for before, after in pairwise(speeds[turn:]))
    assert speeds[-1] == -70


@pytest.mark.parametrize("pause", [0.04, 0.1, 0.25])
def test_a_ramp_does_not_jump_after_a_pause(armed: Rig, pause: float) -> None:
    """It goes on by two reports' worth at most: 1.4 counts."""
    armed.tilt(0.6)
    armed.run(0.1)
    before = armed.sent[-1].levels[0]
    armed.connected = False
    armed.run(pause)
    armed.connected = True
    armed.run(0.01)
    assert armed.sent[-1].levels[0] <= before + 2


def test_only_reports_of_this_session_become_samples(rig: Rig) -> None:
    rig.board.session = 55
    rig.board.ignores_configure = True
    rig.run(0.5)
    assert rig.samples == []
    rig.board.ignores_configure = False
    rig.run(0.5)
    assert rig.samples
    assert rig.samples[0].tick.epoch == 7


def test_frames_of_other_kinds_change_nothing(rig: Rig) -> None:
    rig.drive(0.3)
    state = rig.base.state()
    hello = HelloFrame(seq=0, board_us=0, board=1, protocol_hash=PROTOCOL_HASH, boot_id=77, reset_cause=0)
    assert rig.base.on_frames([hello], rig.now) == []
    assert rig.base.next_frame(rig.now) is None
    assert rig.base.state() == state


def test_state_is_the_newest_frame_and_report(rig: Rig) -> None:
    assert str(rig.base.state().reason) == "no report from the base board yet"
    assert not rig.base.state().board.connected
    rig.drive(0.3)
    state = rig.base.state()
    assert (state.armed, state.driving, str(state.reason), state.guard) == (True, True, "", "guard-1")
    assert state.round_trip == pytest.approx(0.03, abs=0.021)
    assert state.budget_left == pytest.approx(0.19, abs=0.021)
    assert state.board.connected
    assert state.board.drive_state == "active"
    assert state.board.last_refusal == "none"
    assert state.board.accepted > 100
    rig.board.refusal = Refusal.STALE
    rig.run(0.02)
    assert rig.base.state().board.last_refusal == "stale"
    rig.base.on_link_lost(Trouble("the port is gone", "plug it in"))
    state = rig.base.state()
    assert (state.armed, state.driving, str(state.reason)) == (False, False, "the port is gone; plug it in")
    assert (state.round_trip, state.budget_left) == (None, None)
    assert not state.board.connected


def test_what_the_guard_gives_as_reason_is_passed_on(driven: Rig) -> None:
    driven.reason = "forward blocked: front sees something at 0.30 m; turn, or back up"
    driven.tilt(0.0)
    driven.run(0.1)
    assert str(driven.base.state().reason) == str(driven.reason)


def test_without_a_guard_that_is_the_reason(rig: Rig) -> None:
    rig.guard_speaks = False
    rig.run(0.5)
    assert "guard" in str(rig.base.state().reason)
    rig = Rig()
    rig.drive(0.6)
    rig.guard_speaks = False
    rig.run(0.5)
    assert "start giraff_guard" in str(rig.base.state().reason)


def test_battery_is_published_where_its_divider_is_known(rig: Rig) -> None:
    assert rig.base.battery() is None
    rig.run(0.1)
    battery = rig.base.battery()
    assert battery is not None
    assert battery.voltage == pytest.approx(24.0)
    unknown = Rig(drive=msgspec.structs.replace(DRIVE, battery_volts_per_count=0.0))
    unknown.run(0.1)
    assert unknown.base.battery() is None


@given(state=st.sampled_from(DriveState), refusal=st.sampled_from(Refusal))
def test_every_state_and_refusal_of_the_board_has_a_word(state: DriveState, refusal: Refusal) -> None:
    rig = Rig()
    rig.base.on_frames([msgspec.structs.replace(rig.board.report(), drive_state=state, last_refusal=refusal)], rig.now)
    rig.base.next_frame(rig.now)
    assert rig.base.state().board.drive_state == state.name.lower()
    assert rig.base.state().board.last_refusal == refusal.name.lower()
