"""The list of mutants is one that `make mutants` can try."""

import ast

import pytest

from tests.mutants.laboratory import LIST, Mutant, MutantError, mutated, read_mutants
from tests.rules.node_ids import exists, is_simulated
from tests.rules.repository import ROOT

MUTANTS = read_mutants()
ON_A_NETWORK = {
    "router: passes on only what a certificate may say",
    "robot: takes of a router no word that only its own hosts say",
}
"""Rules that Zenoh keeps: nothing but real processes on a network shows one broken."""


def wrong_with(mutant: Mutant, sound: str) -> str:
    """Return why it shows nothing; an empty text for a good one. Any test would fail on a file that is no Python."""
    try:
        mutated(sound, mutant)
        if mutant.file.endswith(".py"):
            before, after = sound.split(mutant.old)
            around = "\n\n\n"  # a function or class
            ast.parse(before.rpartition(around)[2] + mutant.new + after.partition(around)[0])
    except (MutantError, SyntaxError) as error:
        return f"{mutant.file}: {error}"
    return ""


def test_each_mutant_breaks_what_is_there() -> None:
    texts = {file: (ROOT / file).read_text() for file in {mutant.file for mutant in MUTANTS}}
    found = {mutant.rule: wrong_with(mutant, texts[mutant.file]) for mutant in MUTANTS}
    assert {rule: wrong for rule, wrong in found.items() if wrong} == {}


def test_there_are_some_in_both_languages() -> None:
    kinds = {suffix: sum(mutant.file.endswith(suffix) for mutant in MUTANTS) for suffix in (".c", ".py")}
    assert min(kinds.values()) >= 8, kinds


def test_none_is_taken_away_unseen() -> None:
    first, _, _ = LIST.read_text().partition("\n")
    assert first == f"# {len(MUTANTS)} mutants. The number may only fall in a commit that says why."


def test_no_rule_is_listed_twice() -> None:
    assert len({mutant.rule for mutant in MUTANTS}) == len(MUTANTS)
    assert len({(mutant.file, mutant.old, mutant.new) for mutant in MUTANTS}) == len(MUTANTS)


def test_whoever_is_to_notice_is_in_the_simulated_part_of_make_test() -> None:
    assert [mutant.killed_by for mutant in MUTANTS if not exists(mutant.killed_by)] == []
    elsewhere = {mutant.rule for mutant in MUTANTS if not is_simulated(mutant.killed_by)}
    assert elsewhere <= ON_A_NETWORK


def test_who_is_not_there_or_not_simulated_shows() -> None:
    here = "tests/rules/test_mutants.py"
    name = test_no_rule_is_listed_twice.__name__
    assert is_simulated(here)
    assert is_simulated(f"{here}::{name}")
    assert is_simulated(f"{here}::{name}[a row]")
    assert not exists(f"{here}::{name}_at_all")
    assert not exists(f"{here}::ON_A_NETWORK")
    assert not exists("tests/rules/test_nothing.py")
    assert not exists("tests/rules/repository.py")
    assert not is_simulated("tests/mutants/test_mutants.py")


@pytest.mark.parametrize("text", ["", "if late:", "if old: if old:"])
def test_a_mutant_that_breaks_nothing_shows(text: str) -> None:
    mutant = Mutant(rule="r", file="f.py", old="if old:", new="if True:", killed_by="t")
    assert "not once" in wrong_with(mutant, text)


def test_what_is_no_python_shows() -> None:
    assert wrong_with(Mutant(rule="r", file="f.py", old="if old:", new="if (:", killed_by="t"), "if old: pass")
