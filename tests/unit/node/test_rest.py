"""The rest of a frame is slept out, and nothing else is: no frame is lost by it, and none comes late."""

from math import inf

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from giraff_node.boards.board_link import SILENCE
from giraff_node.boards.serial_link import REOPEN_PERIOD
from giraff_schemas.framing import Decoder, encode
from giraff_schemas.trouble import Trouble
from giraff_schemas.wire import FRAME_CLASSES, Frame, FrameType, WheelsFrame
from tests.unit.node.board_lines import BYTE, HELLO, LATE, FakeLoop, carried

WHEELS = WheelsFrame(*range(1, 20))
REPORT = encode(WHEELS.pack())
PERIOD = 0.01
"""s between two reports."""
LONGEST = BYTE * (max(kind.layout.size for kind in FRAME_CLASSES.values()) + 4)
"""s that a frame takes on the line."""
LUMP = 1e-3
"""s; of USB."""
START = 0.1
"""s; the moment at which a test's line begins."""


def _frames_of(kind: FrameType) -> st.SearchStrategy[Frame]:
    if kind is FrameType.HELLO:
        return st.just(HELLO)  # another board's would be refused
    size = FRAME_CLASSES[kind].layout.size - 1
    return st.binary(min_size=size, max_size=size).map(
        lambda fields: FRAME_CLASSES[kind].unpack(bytes((kind,)) + fields)
    )


FRAMES = st.sampled_from(FrameType).flatmap(_frames_of)
ENCODED = FRAMES.map(lambda frame: encode(frame.pack()))
NOISE = st.binary(min_size=1, max_size=80)
TORN = st.tuples(ENCODED, st.integers(1, 40)).map(lambda drawn: drawn[0][: drawn[1]] + b"\0")


@pytest.fixture
def loop() -> FakeLoop:
    return FakeLoop()


@given(ENCODED, st.integers(0, 60), st.binary(max_size=20))
def test_what_is_missing_is_known_with_the_second_byte(encoded: bytes, split: int, before: bytes) -> None:
    decoder = Decoder()
    decoder.feed(before + b"\0" + encoded[:split])
    assert decoder.missing == (len(encoded) - split if 2 <= split <= len(encoded) else 0)


@pytest.mark.parametrize("data", [b"", b"\x01\x02", b"\x05\x63", b"\x05" + bytes((FrameType.WHEELS,)) + b"x" * 100])
def test_of_what_is_no_frame_nothing_is_missing(data: bytes) -> None:
    decoder = Decoder()
    decoder.feed(data)
    assert decoder.missing == 0


@pytest.mark.parametrize("first", range(1, 12))
def test_a_report_in_lumps_of_a_millisecond_wakes_three_times_and_makes_one_turn(loop: FakeLoop, first: int) -> None:
    """`first`: bytes in the first lump. Of one that is alone nothing is known."""
    for number in range(20):
        loop.line.coming += carried(REPORT, START + number * PERIOD - (first + 0.5) * BYTE, LUMP)
    loop.run(START + 0.25)
    assert loop.frames == [WHEELS] * 20
    assert loop.wakes <= (3 if first > 1 else 4) * 20
    assert loop.turns == 20


def test_a_report_byte_by_byte_wakes_three_times_and_makes_one_turn(loop: FakeLoop) -> None:
    for number in range(20):
        loop.line.coming += carried(REPORT, START + number * PERIOD)
    loop.run(START + 0.25)
    assert loop.frames == [WHEELS] * 20
    assert loop.wakes <= 3 * 20
    assert loop.turns == 20


def test_a_port_that_is_pulled_out_makes_a_turn_and_its_frames_are_gone(loop: FakeLoop) -> None:
    loop.line.now, loop.line.coming = START, [(START, REPORT)]
    assert loop.link.ready(START)
    loop.line.is_there = False
    assert loop.link.ready(START + 1e-3)
    loop.line.is_there = True
    assert loop.link.ready(START + REOPEN_PERIOD)
    assert loop.poll(START + REOPEN_PERIOD) == []


@given(st.lists(FRAMES, max_size=20), st.sampled_from((0.0, 0.125e-3, LUMP, 16e-3)), st.floats(0.0, LUMP))
def test_a_whole_frame_is_taken_when_it_is_there(frames: list[Frame], lump: float, start: float) -> None:
    """Of whatever kind, with the pauses that a board makes, however its adapter delivers: to a byte, and two wakes."""
    loop = FakeLoop()
    there = []
    for number, frame in enumerate(frames):
        loop.line.coming += carried(encode(frame.pack()), START + number * PERIOD + start, lump)
        there.append(loop.line.coming[-1][0])
    loop.run(START + len(frames) * PERIOD + 0.05)
    assert loop.frames == frames
    assert all(at <= arrived + BYTE + 2 * LATE for (at, _), arrived in zip(loop.took, there, strict=True))


CHUNKS = st.lists(
    st.tuples(st.floats(0.0, PERIOD), ENCODED | NOISE | TORN | ENCODED.map(lambda data: data[:7])), max_size=30
)


@given(CHUNKS, st.floats(0.4e-3, 0.1))
@example([(0.0, REPORT[:20] + b"\0"), (1e-3, REPORT)], 0.1)
@example([(0.0, REPORT[:20]), (0.0, REPORT[20:] + REPORT + REPORT[:2]), (1e-5, REPORT[2:])], 0.1)
def test_no_noise_and_no_haste_hides_a_frame(chunks: list[tuple[float, bytes]], period: float) -> None:
    """All that a decoder finds is handed out, and less than a frame's time after it came; `period` s of other turns."""
    loop, decoder = FakeLoop(), Decoder()
    there = []
    at = START
    for pause, data in chunks:
        at += pause
        loop.line.coming.append((at, data))
        there += [(at, frame) for frame in decoder.feed(data)]
    loop.run(at + 0.05, period)
    assert loop.frames == [frame for _, frame in there]
    assert all(taken < arrived + LONGEST for (taken, _), (arrived, _) in zip(loop.took, there, strict=True))


def half(loop: FakeLoop) -> float:
    """Let half a report come, and rest; until when."""
    loop.line.coming += [(START, REPORT[:25])]
    loop.poll(START)
    assert loop.link.descriptor() is None
    assert loop.link.wait(START) == pytest.approx((len(REPORT) - 25) * BYTE)
    return START + loop.link.wait(START)


def test_a_board_that_hangs_in_mid_frame_is_watched_and_costs_nothing(loop: FakeLoop) -> None:
    over = half(loop)
    loop.run(over + 0.5)
    assert loop.wakes == 1
    assert loop.link.descriptor() is not None
    assert loop.link.wait(over + 0.5) == inf
    loop.line.coming = [(over + 0.6, REPORT[25:])]
    loop.run(over + 0.7)
    assert loop.took == [(over + 0.6 + LATE, WHEELS)]


def test_a_board_that_stays_silent_in_mid_frame_is_found_silent(loop: FakeLoop) -> None:
    half(loop)
    loop.run(SILENCE + 0.15)
    assert "silent" in str(loop.link.fault)
    loop.run(SILENCE + 0.35)
    assert loop.link.opened == 2
    assert loop.wakes == 1


def test_another_turn_takes_what_is_there_and_the_rest_goes_on(loop: FakeLoop) -> None:
    over = half(loop)
    loop.line.coming = [(START, REPORT[25:30])]
    assert loop.poll(START + 1e-3) == []
    assert loop.link.descriptor() is None
    assert START + 1e-3 + loop.link.wait(START + 1e-3) == pytest.approx(over)
    loop.line.coming = [(START, REPORT[30:])]
    assert loop.poll(START + 1.1e-3) == [WHEELS]
    assert loop.link.descriptor() is not None


def test_a_port_that_is_pulled_out_meanwhile_and_is_back_is_watched(loop: FakeLoop) -> None:
    over = half(loop)
    loop.line.is_there = False
    assert loop.poll(START + 1e-3) == []
    loop.poll(over)
    assert loop.link.wait(over) == inf
    loop.line.is_there = True
    loop.poll(over + REOPEN_PERIOD)
    assert loop.link.opened == 2
    assert loop.link.descriptor() is not None
    loop.line.coming = [(START + 0.5, encode(HELLO.pack()) + REPORT)]
    loop.run(START + 0.5)
    assert loop.frames == [HELLO, WHEELS]


def test_a_port_that_is_opened_anew_before_the_rest_is_over_does_not_rest(loop: FakeLoop) -> None:
    half(loop)
    loop.line.close(Trouble("for a moment"))
    loop.poll(START + 1e-3)
    assert loop.link.opened == 2
    assert loop.link.descriptor() is not None
    assert loop.link.wait(START + 1e-3) == inf
