"""The examples of the Python client are short: whoever reads one sees all of it at once."""

from pathlib import Path

import pytest

from tests.rules.repository import ROOT

EXAMPLES = sorted((ROOT / "examples").glob("*.py"))
MOST_LINES = 20


def test_there_are_four() -> None:
    assert [path.name for path in EXAMPLES] == ["follow_wall.py", "go_to_place.py", "patrol.py", "plot_path.py"]


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.name)
def test_an_example_is_twenty_lines_at_most(path: Path) -> None:
    assert len(path.read_text(encoding="utf-8").splitlines()) <= MOST_LINES
