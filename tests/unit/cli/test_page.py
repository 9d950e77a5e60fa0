"""Tables and sentences on a terminal, and in a pipe."""

import io

import pytest
from rich.text import Text

from giraff_tools.terminal import page
from tests.unit.cli.typed import Tty

HEADINGS = ("key", "by", ">Hz", ">reordered", "told")
ROWS = [
    ("range/front_right", "ranger", "5.55", "0", "one sentence that is longer than all the others"),
    ("odom", "odometry", "100.00", "12", "/a/path/that/has/no/blank/and/is/folded/where/the/column/ends"),
]


@pytest.mark.parametrize("width", [40, 60, 80, 1000])
def test_no_word_of_a_table_is_torn_and_no_line_is_too_long(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], width: int
) -> None:
    monkeypatch.setattr(page, "_PIPE_WIDTH", width)
    page.print_table(HEADINGS, ROWS)
    shown = capsys.readouterr().out
    lines = shown.splitlines()
    assert all(len(line) <= width and line == line.rstrip() for line in lines)
    words = {
        word for row in (("key", "by", "Hz", "reordered", "told"), *ROWS[:1]) for cell in row for word in cell.split()
    }
    assert words <= set(shown.split())
    assert len(lines) == 3 or width < 1000


def test_a_table_in_a_pipe_fits_a_page_and_a_sentence_is_not_broken(capsys: pytest.CaptureFixture[str]) -> None:
    sentence = "one sentence " * 20
    page.print_table(HEADINGS, [(*ROWS[0][:4], sentence)])
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) > 2
    assert max(map(len, lines)) <= 120
    page.print_trimmed(Text(sentence))
    assert capsys.readouterr().out == f"{sentence.rstrip()}\n"


def test_a_sentence_ends_its_lines_between_two_words(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "30")
    for shown, lines in (
        (Tty(), ["  one sentence that is longer", "  than a line", "next"]),
        (io.StringIO(), None),
    ):
        page.print_wrapped("  one sentence that is longer than a line\nnext", shown)
        told = shown.getvalue().splitlines()
        assert told == (lines or ["  one sentence that is longer than a line", "next"])
