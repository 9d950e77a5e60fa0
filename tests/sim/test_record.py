"""The black box's verdicts."""

from giraff_schemas.boards import BASE_BOARD
from giraff_schemas.framing import encode
from giraff_schemas.wire import WheelsFrame
from giraff_sim.record import WINDOW_US, Record

MS = 1000


def telemetry(seq: int, accepted: int, refused: int = 0, boot_id: int = 1) -> bytes:
    frame = WheelsFrame(
        seq=seq,
        board_us=0,
        board_ms=0,
        boot_id=boot_id,
        session=1,
        left_ticks=0,
        right_ticks=0,
        left_pwm_counts=0,
        right_pwm_counts=0,
        drive_state=0,
        latch=0,
        last_refusal=0,
        accepted=accepted,
        refused=refused,
        line_errors=0,
        battery_adc_counts=0,
        left_um_s=0,
        right_um_s=0,
        speed_flags=0,
    )
    return encode(frame.pack())


def test_it_tells_when_the_motors_were_last_driven() -> None:
    record = Record(WheelsFrame, BASE_BOARD.frames)
    for millisecond in range(1, 101):
        record.note_drive(millisecond * MS, 35 if 20 <= millisecond <= 40 else 70 if millisecond == 60 else 0)
    whole = record.window(0, 100 * MS)
    assert whole.first_driven_us == 20 * MS
    assert whole.last_driven_us == 60 * MS
    assert whole.driven_ms == 22
    assert whole.peak_counts == 70
    middle = record.window(29 * MS, 35 * MS)
    assert (middle.first_driven_us, middle.last_driven_us, middle.driven_ms) == (30 * MS, 35 * MS, 6)
    assert middle.peak_counts == 35
    quiet = record.window(60 * MS, 100 * MS)
    assert (quiet.first_driven_us, quiet.last_driven_us, quiet.driven_ms, quiet.peak_counts) == (
        None,
        None,
        0,
        0,
    )


def test_it_counts_what_the_board_says_it_accepted_and_refused() -> None:
    record = Record(WheelsFrame, BASE_BOARD.frames)
    for seq, (accepted, refused) in enumerate([(65534, 5), (65535, 5), (65535, 6), (1, 6), (1, 6), (2, 9)]):
        record.note_sent(seq * 10 * MS, telemetry(seq, accepted, refused))
    verdict = record.window(0, 50 * MS)
    assert verdict.telemetry == 5
    assert verdict.accepted == 4  # across the counter's wrap
    assert verdict.refused == 4
    assert verdict.first_accepted_us == 10 * MS
    assert verdict.last_accepted_us == 50 * MS
    assert verdict.longest_accept_gap_us == 20 * MS
    assert record.window(0, 30 * MS).longest_accept_gap_us == 20 * MS
    assert record.window(35 * MS, 45 * MS).last_accepted_us is None


def test_frames_come_in_pieces_and_damaged() -> None:
    record = Record(WheelsFrame, BASE_BOARD.frames)
    data = telemetry(1, 0) + b"\x05noise\x00" + telemetry(2, 3)
    for at, byte in enumerate(data):
        record.note_sent(at, bytes((byte,)))
    assert record.window(0, len(data)).telemetry == 2
    assert record.window(0, len(data)).accepted == 3


def test_a_reboot_starts_the_counters_anew() -> None:
    record = Record(WheelsFrame, BASE_BOARD.frames)
    record.note_sent(10 * MS, telemetry(1, 100, boot_id=1))
    record.note_sent(20 * MS, telemetry(0, 2, boot_id=2))
    assert record.window(15 * MS, 20 * MS).accepted == 2


def test_it_finds_driving_that_nobody_asked_for() -> None:
    record = Record(WheelsFrame, BASE_BOARD.frames)
    for millisecond in range(1, 1001):
        now_us = millisecond * MS
        record.note_drive(now_us, 35 if 100 <= millisecond < 700 else 0)
        if millisecond % 10 == 0 and millisecond <= 400:
            record.note_sent(now_us, telemetry(millisecond, millisecond // 10))
    assert record.window(0, 1000 * MS).longest_driven_unasked_us == 299 * MS
    assert record.window(0, 400 * MS).longest_driven_unasked_us == 10 * MS
    assert record.window(700 * MS, 1000 * MS).longest_driven_unasked_us == 0


def test_it_keeps_its_window_and_forgets_what_is_older() -> None:
    record = Record(WheelsFrame, BASE_BOARD.frames)
    for second in range(5000):
        record.note_drive(second * 1000 * MS, second % 2)
        record.note_sent(second * 1000 * MS, telemetry(second, second))
    newest = record.window(4999 * 1000 * MS - WINDOW_US, 5000 * 1000 * MS)
    assert newest.telemetry == 100
    assert newest.driven_ms == 50
    assert len(record._told) < 100 + 1024 + 2
    assert len(record._drives) < 100 + 1024 + 2
