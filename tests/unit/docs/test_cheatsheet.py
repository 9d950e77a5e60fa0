"""docs/cheatsheet.md has every command of `giraff`, once, in the groups of `giraff --help`."""

import re
from collections import Counter

from giraff_cli.main import GROUPS
from tests.rules.repository import ROOT
from tests.unit.cli.test_any_command import whole_commands
from tests.unit.docs.blocks import commands


def test_every_command_is_on_the_page_once() -> None:
    lines = [" ".join(each.words[1:3]) for each in commands("docs/cheatsheet.md") if each.words[0] == "giraff"]
    known = whole_commands()
    assert Counter(line if line in known else line.split(" ", maxsplit=1)[0] for line in lines) == Counter(known.keys())


def test_it_has_the_groups_of_the_help() -> None:
    sections = (ROOT / "docs" / "cheatsheet.md").read_text().split("\n## ")[1:]
    shown = {each.partition("\n")[0]: set(re.findall(r"^giraff ([a-z0-9]+)", each, re.MULTILINE)) for each in sections}
    assert shown == {heading: set(verbs) for heading, verbs in GROUPS.items()}
