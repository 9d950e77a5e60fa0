"""Docstrings that begin with a clause or a fragment become fewer: an editor shows one without its neighbours."""

import re
from collections.abc import Mapping, Sequence
from typing import Final

from tests.rules.repository import ROOT, SOURCE_ROOTS, name, sources
from tests.support.tools import finished

CLAUSES: Final = 989
"""Number of docstrings, of attributes too, that begin with one of `WORDS`. Nobody raises it."""
WORDS: Final = ("What", "Of", "That", "Whoever", "Who", "Where", "How", "Why")
BEGINS: Final = re.compile(rf"^ *\"\"\" *({'|'.join(WORDS)})\b", re.MULTILINE)
"""A string at the beginning of a line is a docstring: of a module, class or function, or of the attribute before it.
The syntax tree gives the same number, in a second for all modules instead of a thirtieth."""
INSTEAD: Final = 'begin with a verb or a noun phrase ("Return the …", "m/s. Largest speed …")'


def clauses(source: str) -> list[str]:
    """Return the first lines of such docstrings, each with its number."""
    lines = source.splitlines() if BEGINS.search(source) else []
    return [f"{number}: {line.strip()}" for number, line in enumerate(lines, start=1) if BEGINS.match(line)]


def told(found: Mapping[str, Sequence[str]], most: int, changed: Sequence[str]) -> str:
    """Say what to do about these docstrings, by file. Empty: they are as many as may be."""
    number = sum(map(len, found.values()))
    if number < most:
        return f"write CLAUSES: Final = {number} in tests/rules/test_docstrings.py: the count only falls"
    if number == most:
        return ""
    lines = [f"{number} docstrings begin with {', '.join(WORDS)}, and {most} may: {INSTEAD}."]
    lines += [f"{path}:{line}" for path in changed for line in found.get(path, ())]
    return "\n".join([*lines, "By file:", *(f"{path}: {len(each)}" for path, each in found.items() if each)])


def test_docstrings_that_begin_with_a_clause_become_fewer() -> None:
    found = {name(path): clauses(path.read_text()) for path in sources(".py", under=SOURCE_ROOTS)}
    changed: list[str] = []
    if sum(map(len, found.values())) > CLAUSES:
        listing = ["git", "diff", "--name-only", "HEAD", "--", *SOURCE_ROOTS]
        changed = finished(listing, cwd=ROOT, check=True).stdout.splitlines()
    why = told(found, CLAUSES, changed)
    assert not why, why


def test_each_kind_of_docstring_counts_and_one_more_or_less_is_told() -> None:
    source = (
        '"""What it is."""\nspeed = 1\n"""Of the robot."""\nhow = """How"""\n'
        'class A:\n    """Whoever asks."""\n    b: int\n    """m/s."""\n\n    def c(self):\n        """Why not."""\n'
    )
    found = {"a.py": clauses(source)}
    assert found["a.py"] == [
        '1: """What it is."""',
        '3: """Of the robot."""',
        '6: """Whoever asks."""',
        '11: """Why not."""',
    ]
    assert told(found, 4, []) == ""
    assert "CLAUSES: Final = 4" in told(found, 5, [])
    more = told(found, 3, ["a.py"])
    assert "begin with a verb or a noun phrase" in more
    assert more.endswith('a.py:11: """Why not."""\nBy file:\na.py: 4')
