"""Each way in which a person in a hurry types a stop."""

import shlex
from typing import Any

import pytest

from giraff_cli.estop import engage
from tests.unit.cli.quiet_network import meet
from tests.unit.cli.typed import Giraff

WAYS = {
    "stop": "",
    "estop": "",
    "estop stop": "",
    "estop engage": "",
    "estop --reason rest": "",
    "stop anne": "anne",
    "estop anne": "anne",
    "estop stop anne": "anne",
    "estop engage anne": "anne",
    "estop --robot anne": "anne",
    "stop anne otto anne": "anne otto",
    "estop otto --robot anne": "anne otto",
    "stop stop": "",
    "estop STOP": "",
    "estop engage engage": "",
    "estop --timeout 1 engage": "",
    "estop --robot=anne stop": "anne",
    "estop --robot anne engage": "anne",
    "estop anne engage otto": "anne otto",
    "estop --reason reset anne": "anne",
    "stop ''": "",
}
"""By what is typed: the robots that are asked to stop; empty: all that are heard."""


@pytest.mark.parametrize("words", WAYS)
def test_whoever_types_a_stop_stops(monkeypatch: pytest.MonkeyPatch, giraff: Giraff, words: str) -> None:
    """The worst code is that of the command."""
    asked: list[str] = []

    def stop(robot: str | None, *_: Any, **__: Any) -> int:
        asked.append(robot or "all")
        return 1 if robot == "otto" else 0

    monkeypatch.setattr(engage, "engage_by_plan", stop)
    monkeypatch.setattr("sys.stdin.isatty", lambda: True, raising=False)
    code, out, err = giraff(*shlex.split(words))
    robots = WAYS[words].split() or ["all"]
    assert (code, out, err) == (1 if "otto" in robots else 0, "", "")
    assert sorted(asked) == sorted(robots)


@pytest.mark.parametrize(
    "words",
    [
        *("estop", "estop --help", "estop stop --help", "estop reset now", "estop anne --of"),
        *("estop otto reset", "estop --off reset", "estop --robot otto --off status"),
    ],
)
def test_another_verb_a_question_for_help_and_a_program_without_a_terminal_stop_nothing(
    monkeypatch: pytest.MonkeyPatch, giraff: Giraff, words: str
) -> None:
    monkeypatch.setattr(engage, "engage_by_plan", lambda *_, **__: pytest.fail("it stops"))
    code, out, err = giraff(*words.split())
    assert code == (0 if "--help" in words else 2)
    assert "Usage: giraff estop" in out or err.endswith(" --help)\n")
    assert "anne" not in err or "no option --of: did you mean --off?" in err


@pytest.mark.parametrize(
    ("word", "meant"), [("rest", "did you mean reset? "), ("engae", "did you mean engage? "), ("all", ""), ("now/", "")]
)
def test_a_word_that_is_no_robots_name_stops_nothing_and_says_what_does(
    monkeypatch: pytest.MonkeyPatch, giraff: Giraff, word: str, meant: str
) -> None:
    network = meet(monkeypatch, "giraff/sim-test/alive/base/1")
    code, out, err = giraff("estop", word)
    assert (code, out) == (2, "")
    assert f"giraff: {word} has not confirmed a stop; {meant}`giraff stop` stops every robot that is heard" in err
    assert bool(network.opened) == (word != "now/")
