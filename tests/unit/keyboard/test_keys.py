"""Which bytes are a key press, and which only look like one."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from giraff_keyboard.keys import ALONE, ASLEEP, KeyReader
from giraff_keyboard.policy import Key

PLAIN = {
    b"w": Key.FORWARD,
    b"s": Key.BACKWARD,
    b"a": Key.LEFT,
    b"d": Key.RIGHT,
    b"\x1b[A": Key.FORWARD,
    b"\x1b[B": Key.BACKWARD,
    b"\x1b[D": Key.LEFT,
    b"\x1b[C": Key.RIGHT,
    b"\x1bOA": Key.FORWARD,
    b"\x1bOC": Key.RIGHT,
    b"c": Key.CLUTCH,
    b" ": Key.STOP,
    b"+": Key.FASTER,
    b"=": Key.FASTER,
    b"-": Key.SLOWER,
    b"r": Key.RESET,
    b"y": Key.YES,
}
MOVING = {Key.FORWARD, Key.BACKWARD, Key.LEFT, Key.RIGHT}


def typed(*parts: bytes, gap: float = 0.033) -> list[Key]:
    """What is read when these bytes come one after the other."""
    reader = KeyReader()
    return [key for step, part in enumerate((b"", *parts)) for key in reader.feed(part, 10.0 + step * gap)]


@pytest.mark.parametrize(("data", "key"), PLAIN.items())
def test_a_key_is_what_it_says(data: bytes, key: Key) -> None:
    assert typed(data) == [key]


@pytest.mark.parametrize("data", [data for data in PLAIN if len(data) > 1])
def test_a_sequence_that_comes_in_pieces_is_one_press(data: bytes) -> None:
    assert typed(*(bytes((byte,)) for byte in data)) == [PLAIN[data]]


@pytest.mark.parametrize(
    "data",
    [
        *(b"W", b"A", b"x", b"\r", b"\t", b"\x7f", b"\x00", b"\xc3\xa4", b"\xff"),
        *(b"\x17", b"\x01", b"\x13", b"\x04"),  # Ctrl and w, a, s, d
        *(b"\x1bw", b"\x1ba", b"\x1bc", b"\x1b\x1bw"),  # Alt
        *(b"\x1b[1;5A", b"\x1b[1;3C", b"\x1b[1;2D", b"\x1bO5A", b"\x1b\x1b[1;5B"),  # Ctrl, Alt, Shift and an arrow
        *(b"\x1b[5~", b"\x1b[15~", b"\x1bOP", b"\x1b[H", b"\x1b[[A", b"\x1b[Z", b"\x1b[?1;2c", b"\x1b[24;80R"),
        *(b"\x1b[M#wd", b"\x1b[<0;12;34M", b"\x1b[I", b"\x1b]11;rgb:dada/dada/dada\x07", b"\x1bP>|wsad\x1b\\"),
        *(b"\x1b", b"\x1b[", b"\x1bO", b"\x1b[20"),
    ],
)
def test_what_is_no_plain_press_moves_nothing_torn_or_whole(data: bytes) -> None:
    assert set(typed(data)) <= {Key.NOTHING}
    assert set(typed(*(bytes((byte,)) for byte in data))) <= {Key.NOTHING}


@pytest.mark.parametrize("head", [b"\x1b", b"\x1b[", b"\x1b[1;", b"\x1bO"])
def test_a_torn_head_takes_the_next_key_with_it_however_late(head: bytes) -> None:
    reader = KeyReader()
    reader.feed(head, 0.0)
    for step in range(1, 50):
        reader.feed(b"", step * 0.03)
    assert set(reader.feed(b"w", 1.5)) <= {Key.NOTHING}
    assert reader.feed(b"w", 1.6) == [Key.FORWARD]


@pytest.mark.parametrize("paste", [b"dad", b"ww", b"wasd wasd", b"ry", b"r\ny", b"\x1b[A\x1b[A", b"cd /\n"])
def test_what_comes_together_is_no_press(paste: bytes) -> None:
    keys = typed(paste)
    assert not MOVING & set(keys)
    assert Key.NOTHING in keys
    assert (Key.STOP in keys) == (b" " in paste)


def test_a_marked_paste_moves_nothing_however_slowly_it_comes() -> None:
    paste = b"\x1b[200~wasd\x1b[A" + b"c+" + b"\x1b[201~"
    assert set(typed(*(bytes((byte,)) for byte in paste))) == {Key.NOTHING}
    assert typed(paste, b"w")[-1] is Key.FORWARD


def test_a_stop_counts_in_any_company() -> None:
    for data in (b" ", b"wwww w", b"\x1b ", b"\x1b[ ", b"\x1b[1; ", b"\x1b]w ", b"\x1b[200~w ", b"\xff "):
        assert Key.STOP in typed(data), data


def test_a_key_that_bounces_is_taken_back() -> None:
    reader = KeyReader()
    reader.feed(b"", -ALONE)
    assert reader.feed(b"w", 0.0) == [Key.FORWARD]
    assert reader.feed(b"w", ALONE / 2) == [Key.NOTHING]
    assert reader.feed(b"w", ALONE / 2 + 0.033) == [Key.FORWARD]


@pytest.mark.parametrize("rate", [10.0, 30.0, 50.0])
def test_a_held_key_is_a_press_each_time_it_repeats(rate: float) -> None:
    assert typed(*[b"w"] * 40, gap=1.0 / rate) == [Key.FORWARD] * 40


def test_what_was_typed_before_the_program_looked_moves_nothing() -> None:
    reader = KeyReader()
    assert reader.feed(b"w", 5.0) == [Key.NOTHING]
    assert reader.feed(b"w", 5.033) == [Key.FORWARD]


def test_what_was_typed_while_the_program_slept_moves_nothing() -> None:
    reader = KeyReader()
    reader.feed(b"", 0.0)
    assert reader.feed(b"w", ASLEEP + 0.01) == [Key.NOTHING]
    assert reader.feed(b" ", 2.0 * ASLEEP + 0.02) == [Key.STOP, Key.NOTHING]
    assert reader.feed(b"w", 2.0 * ASLEEP + 0.06) == [Key.FORWARD]


@given(st.lists(st.tuples(st.binary(max_size=6), st.floats(0.0, 0.3)), max_size=40))
def test_any_bytes_at_all_are_read(parts: list[tuple[bytes, float]]) -> None:
    """Never more than one press from one look, and each moving one is of bytes that came alone."""
    reader, now = KeyReader(), 0.0
    for data, later in parts:
        now += later
        keys = reader.feed(data, now)
        assert (Key.STOP in keys) == (b" " in data)
        assert len([key for key in keys if key is not Key.STOP]) <= 1
        if MOVING & set(keys):
            assert later <= ASLEEP
            assert data[-1:] in {*(b"w", b"a", b"s", b"d"), *(b"A", b"B", b"C", b"D")}
