"""Who may drive the base board's motors, with what, and for how long."""

import msgspec
import pytest

from giraff_schemas.framing import encode
from giraff_schemas.wire import (
    COMMAND_TIMEOUT_MS,
    ECHO_MAX_AGE_MS,
    PROTOCOL_HASH,
    DriveFrame,
    DriveState,
    Refusal,
    Wiring,
)
from tests.firmware.bench import BaseBench, out_of_place

TELEMETRY_MS = 15  # within which telemetry tells of what has happened
FRAME_MS = 2  # within which a drive frame has come over the line
CONFIGURE_MS = 6  # within which a configure frame has: it is 65 bytes long


def board_ms_on_arrival(base: BaseBench) -> int:
    """The board's time when a drive frame that is sent now has arrived: it counts from its power-on, too."""
    return base.now_ms + FRAME_MS - 1


def test_a_fresh_board_drives_only_after_a_handshake_and_a_zero(base: BaseBench) -> None:
    assert base.wheels().drive_state == DriveState.NOT_CONFIGURED
    assert base.wheels().session == 0
    base.drive(0, 0)
    base.drive(40, 40)
    assert (base.wheels().drive_state, base.wheels().last_refusal) == (
        DriveState.NOT_CONFIGURED,
        Refusal.NOT_CONFIGURED,
    )
    base.configure(session=12)
    assert (base.wheels().drive_state, base.wheels().session) == (DriveState.AWAITING_ZERO, 12)
    base.drive(40, 40)
    assert (base.wheels().drive_state, base.wheels().last_refusal) == (DriveState.AWAITING_ZERO, Refusal.AWAITING_ZERO)
    assert base.model.motor[0].drive_peak == base.model.motor[1].drive_peak == 0
    base.drive(0, 0)
    assert base.wheels().drive_state == DriveState.ACTIVE
    base.drive(40, -30)
    assert base.duties() == (40, -30)
    assert (base.wheels().left_pwm_counts, base.wheels().right_pwm_counts) == (40, -30)


@pytest.mark.parametrize(
    ("changes", "refusal"),
    [
        ({"protocol_hash": PROTOCOL_HASH ^ 1}, Refusal.PROTOCOL),
        ({"session": 0}, Refusal.PROTOCOL),
        ({"level_max": 0}, Refusal.PROTOCOL),
        ({"stall_level": 0}, Refusal.PROTOCOL),
        ({"wiring": 64}, Refusal.PROTOCOL),
        ({"boot_id": 2}, Refusal.BOOT_ID),
        ({"boot_id": 0}, Refusal.BOOT_ID),
        ({"board_ms": 0xFFFFFF00}, Refusal.STALE),
        ({"board_ms": 1000}, Refusal.STALE),
    ],
)
def test_a_configure_frame_that_proves_nothing_is_refused(
    base: BaseBench, changes: dict[str, int], refusal: Refusal
) -> None:
    base.configure(**changes)
    assert (base.wheels().last_refusal, base.wheels().refused) == (refusal, 1)
    assert (base.wheels().drive_state, base.wheels().session) == (DriveState.NOT_CONFIGURED, 0)
    base.drive(0, 0)
    base.drive(40, 40)
    assert base.model.motor[0].drive_peak == 0


def test_a_configure_frame_may_echo_a_time_as_old_as_a_drive_frame_may(base: BaseBench) -> None:
    base.run(300)
    oldest = CONFIGURE_MS - 1 - ECHO_MAX_AGE_MS  # from now: as old as it may be when the frame has come
    base.configure(board_ms=base.now_ms + oldest - 1)
    assert base.wheels().last_refusal == Refusal.STALE
    base.configure(board_ms=base.now_ms + oldest)
    assert base.wheels().session == 7


def test_a_refused_configure_frame_leaves_the_session_as_it_is(base: BaseBench) -> None:
    base.start(40, 40)
    base.send(base.configure_frame(session=8, protocol_hash=1))
    base.run(CONFIGURE_MS + TELEMETRY_MS)
    assert base.duties() == (40, 40)
    assert (base.wheels().session, base.wheels().refused) == (7, 1)


def refusals(base: BaseBench) -> list[tuple[str, DriveFrame, Refusal]]:
    """Each way in which the next drive frame can be wrong, when nothing else is."""
    arrival = board_ms_on_arrival(base)
    good = base.drive_frame(50, 50, board_ms=arrival)
    return [
        *out_of_place(good, arrival),
        ("left too high", msgspec.structs.replace(good, left_level=71), Refusal.LEVEL),
        ("right too low", msgspec.structs.replace(good, right_level=-71), Refusal.LEVEL),
        ("the lowest number there is", msgspec.structs.replace(good, left_level=-0x8000), Refusal.LEVEL),
    ]


@pytest.mark.parametrize("case", range(11))
def test_a_drive_frame_with_one_thing_wrong_is_refused(base: BaseBench, case: int) -> None:
    base.start(40, 40)
    base.drive(40, 40, 200)
    before = base.wheels()
    name, frame, refusal = refusals(base)[case]
    base.send(frame)
    base.run(TELEMETRY_MS)
    assert (name, base.wheels().last_refusal) == (name, refusal)
    assert (base.wheels().accepted, base.wheels().refused) == (before.accepted, before.refused + 1)
    assert base.duties() == (40, 40)
    base.drive(45, 45)
    assert base.duties() == (45, 45), "the next good one is as good as ever"


def test_every_refusal_a_drive_frame_can_meet_is_in_the_table(base: BaseBench) -> None:
    base.start()
    base.drive(0, 0, 200)
    cases = refusals(base)
    assert len(cases) == 11
    assert {refusal for _, _, refusal in cases} == set(Refusal) - {
        Refusal.NONE,
        Refusal.PROTOCOL,
        Refusal.NOT_CONFIGURED,
        Refusal.AWAITING_ZERO,
        Refusal.LATCHED,
    }


@pytest.mark.parametrize(("left", "right"), [(70, -70), (-70, 70), (1, 0), (0, -1)])
def test_levels_up_to_the_configured_maximum_are_accepted(base: BaseBench, left: int, right: int) -> None:
    base.start()
    base.drive(left, right)
    assert base.duties() == (left, right)


@pytest.mark.parametrize("level", [255, -255])
def test_the_maximum_may_be_all_there_is(base: BaseBench, level: int) -> None:
    base.configure(level_max=255)
    base.drive(0, 0)
    base.drive(level, level)
    assert base.duties() == (level, level)


@pytest.mark.parametrize(("age", "accepted"), [(0, 1), (1, 1), (ECHO_MAX_AGE_MS, 1), (ECHO_MAX_AGE_MS + 1, 0)])
def test_a_frame_is_fresh_up_to_150_ms(base: BaseBench, age: int, accepted: int) -> None:
    base.start(40, 40)
    base.drive(40, 40, 200)
    before = base.wheels().accepted
    base.send(base.drive_frame(50, 50, board_ms=board_ms_on_arrival(base) - age))
    base.run(TELEMETRY_MS)
    assert base.wheels().accepted - before == accepted


def test_frames_that_waited_behind_others_grow_old_on_the_line(base: BaseBench) -> None:
    base.start(40, 40)
    before = base.wheels()
    queued = [base.drive_frame(60, 60) for _ in range(200)]
    base.send_bytes(b"".join(encode(frame.pack()) for frame in queued))
    base.run(400)
    told = base.wheels()
    bytes_a_ms = 11.52
    fresh = ECHO_MAX_AGE_MS * bytes_a_ms / len(encode(queued[0].pack()))
    assert 0.85 * fresh < told.accepted - before.accepted <= fresh
    assert told.last_refusal == Refusal.STALE


def test_sequence_numbers_may_skip_and_wrap(base: BaseBench) -> None:
    base.start()
    for seq in (0x6000, 0xDFFF, 0xFFFF, 0, 0x7FFF):
        accepted = base.wheels().accepted
        base.send(base.drive_frame(10, 10, seq=seq))
        base.run(TELEMETRY_MS)
        assert base.wheels().accepted == accepted + 1, hex(seq)


def test_without_accepted_frames_pwm_is_zero_after_300_ms_and_latched(base: BaseBench) -> None:
    base.start(40, 40)
    base.send(base.drive_frame(50, 50))
    base.run(FRAME_MS)
    assert base.stopped_after_ms() == pytest.approx(COMMAND_TIMEOUT_MS, abs=2)
    base.run(TELEMETRY_MS)
    assert base.wheels().drive_state == DriveState.COMMAND_TIMEOUT
    assert (base.wheels().left_pwm_counts, base.wheels().right_pwm_counts) == (0, 0)
    base.model.motor[0].drive_peak = 0
    base.drive(50, 50, 400)
    assert base.wheels().last_refusal == Refusal.AWAITING_ZERO
    assert base.model.motor[0].drive_peak == 0
    base.drive(0, 1)
    assert base.wheels().drive_state == DriveState.COMMAND_TIMEOUT
    base.drive(0, 0)
    assert base.wheels().drive_state == DriveState.ACTIVE
    base.drive(50, 50)
    assert base.duties() == (50, 50)


def test_refused_frames_do_not_put_the_time_out_off(base: BaseBench) -> None:
    base.start(40, 40)
    stale = base.wheels().board_ms
    base.drive(40, 40, 200)
    base.send(base.drive_frame(50, 50))
    base.run(FRAME_MS)

    def send_refused() -> None:
        if base.now_ms % 10 == 0:
            base.send(base.drive_frame(50, 50, board_ms=stale))
            base.send(base.drive_frame(50, 50, boot_id=99))
            base.send(base.drive_frame(99, 99))
            base.send(base.configure_frame(session=0))

    assert base.stopped_after_ms(send_refused) == pytest.approx(COMMAND_TIMEOUT_MS, abs=2)


def test_noise_on_the_line_does_not_put_the_time_out_off(base: BaseBench) -> None:
    base.start(40, 40)
    base.send(base.drive_frame(50, 50))
    base.run(FRAME_MS)
    stopped_ms = base.stopped_after_ms(lambda: base.send_bytes(bytes(range(1, 12))))
    assert stopped_ms == pytest.approx(COMMAND_TIMEOUT_MS, abs=2)


def test_zero_frames_keep_the_board_active(base: BaseBench) -> None:
    base.start(40, 40)
    base.drive(0, 0, 600)
    assert base.wheels().drive_state == DriveState.ACTIVE
    base.drive(30, 30)
    assert base.duties() == (30, 30)


def test_a_stop_takes_the_time_of_its_frame_and_no_more(base: BaseBench) -> None:
    base.start(70, 70)
    base.send(base.drive_frame(0, 0))
    assert base.stopped_after_ms() <= FRAME_MS + 2


def test_a_new_session_stops_forgets_numbers_and_wants_a_zero(base: BaseBench) -> None:
    base.start(40, 40)
    base.send(base.configure_frame(session=8, level_max=20))
    base.run(CONFIGURE_MS + TELEMETRY_MS)
    assert base.duties() == (0, 0)
    assert (base.wheels().drive_state, base.wheels().session) == (DriveState.AWAITING_ZERO, 8)
    base.seq = 0
    base.drive(20, 20)
    assert base.duties() == (0, 0)
    base.drive(0, 0)
    assert base.wheels().drive_state == DriveState.ACTIVE
    base.drive(20, 20)
    assert base.duties() == (20, 20)
    base.drive(21, 21)
    assert base.wheels().last_refusal == Refusal.LEVEL


@pytest.mark.parametrize(
    ("wiring", "duties"),
    [
        (0, (40, 30)),
        (Wiring.SWAP_MOTORS, (30, 40)),
        (Wiring.INVERT_LEFT_MOTOR, (-40, 30)),
        (Wiring.INVERT_RIGHT_MOTOR, (40, -30)),
        (Wiring.SWAP_MOTORS | Wiring.INVERT_LEFT_MOTOR, (30, -40)),
        (Wiring.SWAP_ENCODERS | Wiring.INVERT_LEFT_ENCODER | Wiring.INVERT_RIGHT_ENCODER, (40, 30)),
    ],
)
def test_levels_reach_the_motors_the_wiring_says(base: BaseBench, wiring: int, duties: tuple[float, ...]) -> None:
    base.configure(wiring=wiring)
    base.drive(0, 0)
    base.drive(40, 30)
    assert base.duties() == duties
    assert (base.wheels().left_pwm_counts, base.wheels().right_pwm_counts) == (40, 30)


def test_damaged_and_unknown_frames_are_counted_and_do_nothing(base: BaseBench) -> None:
    base.start(40, 40)
    good = encode(base.drive_frame(60, 60).pack())
    told = base.wheels()
    base.send_bytes(good[:5] + bytes([good[5] ^ 0x10]) + good[6:])
    base.send_bytes(encode(b"\x77\x01\x02\x03"))
    base.send_bytes(encode(base.drive_frame(60, 60).pack() + b"\x00"))
    base.send_bytes(b"\x01" * 100 + b"\x00")
    base.run(2 * TELEMETRY_MS)
    assert base.wheels().line_errors == 4
    assert (base.wheels().accepted, base.wheels().refused) == (told.accepted, told.refused)
    assert base.duties() == (40, 40)


def test_a_frame_with_any_one_bit_changed_is_none(base: BaseBench) -> None:
    base.start(40, 40)
    for bit in range(8):
        for at in range(1, len(encode(base.drive_frame(40, 40).pack())) - 1):
            base.drive(40, 40)
            before = base.wheels()
            good = encode(base.drive_frame(60, 60).pack())
            base.send_bytes(good[:at] + bytes([good[at] ^ (1 << bit)]) + good[at + 1 :])
            base.run(TELEMETRY_MS)
            told = base.wheels()
            assert (told.accepted, told.refused) == (before.accepted, before.refused), (at, bit)
            assert told.line_errors > before.line_errors, (at, bit)
            assert base.duties() == (40, 40)
