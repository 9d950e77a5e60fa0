"""Bytes to lines and back, however they are torn."""

import re
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from giraff_gateway.config import GatewayConfig
from giraff_gateway.policy import LineSplitter, TimedNotices, WriteQueue
from giraff_schemas.trouble import NO_TROUBLE, Trouble

LONGEST = 16
LINE_BYTES = st.lists(
    st.one_of(st.binary(max_size=40), st.sampled_from([b"\r", b"\n", b"\r\n", "ä€😀".encode(), b"\xff"])), max_size=20
).map(b"".join)


def lines_of(data: bytes, cuts: list[int] | None = None, longest: int = LONGEST) -> list[tuple[str, bool, int]]:
    """What comes of `data` if it arrives in pieces."""
    splitter = LineSplitter("arduino", longest)
    edges = [0, *sorted(cut % (len(data) + 1) for cut in cuts or []), len(data)]
    found = [line for begin, end in pairwise(edges) for line in splitter.feed(data[begin:end])]
    return [(line.text, line.goes_on, line.replaced) for line in found]


@pytest.mark.parametrize(
    ("data", "texts"),
    [
        (b"23.5\n", ["23.5"]),
        (b"a\rb\nc\r\nd\n", ["a", "b", "c", "d"]),
        (b"\n\r\n\r", ["", "", ""]),
        (b"a\n\rb\n", ["a", "", "b"]),
        (b"no end yet", []),
        ("21 °C\n".encode(), ["21 °C"]),
        (b"a\x00b\n", ["a\x00b"]),
    ],
)
def test_each_ending_ends_one_line(data: bytes, texts: list[str]) -> None:
    assert [text for text, _, _ in lines_of(data)] == texts


def test_what_is_no_text_is_replaced_and_counted() -> None:
    splitter = LineSplitter("arduino", LONGEST)
    [line] = splitter.feed(b"2\xff3\xc3\n")
    assert (line.text, line.replaced) == ("2\ufffd3\ufffd", 2)
    [line] = splitter.feed("\ufffd\n".encode())
    assert (line.text, line.replaced) == ("\ufffd", 0)


def test_a_line_without_an_end_comes_in_pieces_and_takes_no_memory() -> None:
    splitter = LineSplitter("arduino", LONGEST)
    pieces = list(splitter.feed(b"x" * 1000))
    assert {(len(piece.text), piece.goes_on) for piece in pieces} == {(LONGEST, True)}
    assert len(pieces) == 62
    [last] = splitter.feed(b"\n")
    assert (last.text, last.goes_on) == ("x" * 8, False)


@given(st.text(alphabet="aä€😀", min_size=17, max_size=80))
def test_a_cut_tears_no_character(text: str) -> None:
    found = lines_of(text.encode() + b"\n")
    assert "".join(piece for piece, _, _ in found) == text
    assert [goes_on for _, goes_on, _ in found] == [True] * (len(found) - 1) + [False]
    assert not any(replaced for _, _, replaced in found)
    assert all(len(piece.encode()) <= LONGEST for piece, _, _ in found)


@given(LINE_BYTES, st.lists(st.integers(min_value=0)))
def test_how_it_arrives_makes_no_difference(data: bytes, cuts: list[int]) -> None:
    assert lines_of(data, cuts) == lines_of(data)


@given(LINE_BYTES)
def test_nothing_is_lost_and_no_ending_is_left(data: bytes) -> None:
    whole = data + b"\n"
    texts, begun = [], ""
    for text, goes_on, _ in lines_of(whole, longest=10_000):
        assert "\r" not in text
        assert "\n" not in text
        begun += text
        if not goes_on:
            texts.append(begun)
            begun = ""
    assert texts == [line.decode(errors="replace") for line in re.split(rb"\r\n|\r|\n", whole)[:-1]]


def test_what_waits_is_written_in_order_and_bounded() -> None:
    queue = WriteQueue(16, "\n", most=2)
    refused = [queue.put(text) for text in ("on", "off", "again")]
    assert refused[:2] == [NO_TROUBLE, NO_TROUBLE]
    assert "2 wait" in refused[2].what
    assert [queue.pop(), queue.pop(), queue.pop()] == [b"on\n", b"off\n", b""]
    assert queue.put("x" * 16) == Trouble("a text of 17 bytes was not written: longest_line is 16")
    assert (queue.put("on"), queue.drop(), queue.pop()) == (NO_TROUBLE, 1, b"")


def test_what_is_over_at_once_is_told_for_a_while() -> None:
    passing, refused = TimedNotices(10.0, "write"), Trouble("refused")
    assert passing.now(0.0) == {"write": NO_TROUBLE}
    passing.report("write", refused, 1.0)
    passing.report("write", NO_TROUBLE, 5.0)
    assert (passing.now(11.0), passing.now(11.1)) == ({"write": refused}, {"write": NO_TROUBLE})


@pytest.mark.parametrize(
    "values",
    [
        {"port": ""},
        {"name": "a/b"},
        {"baud": 0},
        {"longest_line": 3},
        {"ending": "END"},
    ],
)
def test_a_table_that_cannot_work_is_refused(values: dict[str, object]) -> None:
    with pytest.raises(ValueError, match=next(iter(values)) if "name" not in values else "part of a key"):
        GatewayConfig(**values)  # type: ignore[arg-type]
