"""docs/cheatsheet.md has every command of `giraff`, once."""

from __future__ import annotations

from collections import Counter

from tests.unit.cli.test_any_command import whole_commands
from tests.unit.docs.blocks import commands


def test_every_command_is_on_the_page_once() -> None:
    lines = [" ".join(each.words[1:3]) for each in commands("docs/cheatsheet.md") if each.words[0] == "giraff"]
    known = whole_commands()
    assert Counter(line if line in known else line.split(" ", maxsplit=1)[0] for line in lines) == Counter(known.keys())
