"""Help is for a person in front of a terminal of 80 columns."""

import re

import pytest

from giraff_cli.main import GROUPS
from giraff_node.process.version import NUMBER, version
from tests.unit.cli.test_any_command import whole_commands
from tests.unit.cli.typed import Giraff


@pytest.mark.parametrize("words", ["", "topic"])
def test_a_word_that_wants_another_shows_its_help(giraff: Giraff, words: str) -> None:
    code, out, err = giraff(*words.split())
    assert (code, err) == (2, "")
    assert "\n  list " in out or "\nDrive:\n" in out


def test_help_has_paragraphs_and_no_types_of_pythons(monkeypatch: pytest.MonkeyPatch, giraff: Giraff) -> None:
    assert [path for path, it in whole_commands().items() if "\n" in it.help.replace("\n\n", "")] == []
    monkeypatch.setenv("TERMINAL_WIDTH", "80")
    shown = []
    for words in ("calibrate odometry", "param list", "odom set", "map convert", "run"):
        _, out, _ = giraff(*words.split(), "--help")
        shown += out.splitlines()
    assert [line for line in shown if re.search(r"<[a-z]+[>|[]", line) or len(line) > 80] == []
    assert any(re.search(r"--boards +avr\|host ", line) for line in shown)
    assert any("--truth TRUTH " in line for line in shown)


def test_h_helps_everywhere_and_the_version_is_told(giraff: Giraff) -> None:
    for path in whole_commands():
        code, out, err = giraff(*path.split(), "-h")
        assert (code, err) == (0, "")
        assert out.startswith(f"Usage: giraff {path} ")
        assert re.search(rf"\n  Example: giraff {path}\b.*\n$", out)
    assert giraff("--version") == (0, f"giraff {version()}\n", "")
    assert version().startswith(NUMBER)


def test_each_verb_stands_in_the_help(giraff: Giraff) -> None:
    _, out, _ = giraff("--help")
    assert out.endswith("\n  Example: giraff run\n")
    shown = [line.split()[0].rstrip(":") for line in out.splitlines() if re.match(r"  [a-z0-9]+ |\S.*:$", line)]
    assert [word for word in shown if word.islower()] == [verb for verbs in GROUPS.values() for verb in verbs]
