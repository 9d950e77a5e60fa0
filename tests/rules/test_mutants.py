"""The list of mutants is one that `make campaign` can try."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest

from tests.campaign.records import RECORDS
from tests.mutants.laboratory import Mutant, MutantError, mutated, read_mutants
from tests.rules.repository import ROOT

MUTANTS = read_mutants()


@pytest.mark.parametrize("mutant", MUTANTS, ids=lambda mutant: mutant.rule)
def test_a_mutant_breaks_what_is_there(mutant: Mutant) -> None:
    assert mutated((ROOT / mutant.file).read_text(), mutant)


def test_there_are_some_in_both_languages() -> None:
    kinds = {suffix: sum(mutant.file.endswith(suffix) for mutant in MUTANTS) for suffix in (".c", ".py")}
    assert min(kinds.values()) >= 8, kinds


def test_none_is_taken_away_unseen() -> None:
    """One rule may take another's place; that there are fewer takes a campaign, whose record shows it."""
    newest = max(RECORDS.glob("*-mutants.json"))
    assert len(MUTANTS) >= json.loads(newest.read_text())["mutants"], newest.name


def test_no_rule_is_listed_twice() -> None:
    assert len({mutant.rule for mutant in MUTANTS}) == len(MUTANTS)
    assert len({(mutant.file, mutant.old, mutant.new) for mutant in MUTANTS}) == len(MUTANTS)


def test_whoever_is_to_notice_exists() -> None:
    named = sorted({mutant.killed_by for mutant in MUTANTS})
    command = [sys.executable, "-m", "pytest", "--collect-only", "-q", "-p", "no:cacheprovider", *named]
    collected = subprocess.run(command, check=False, capture_output=True, text=True, cwd=ROOT)
    assert collected.returncode == 0, collected.stdout[-2000:] + collected.stderr[-2000:]


@pytest.mark.parametrize("text", ["", "if late:", "if old: if old:"])
def test_a_mutant_that_breaks_nothing_shows(text: str) -> None:
    mutant = Mutant(rule="r", file="f.py", old="if old:", new="if True:", killed_by="t")
    with pytest.raises(MutantError, match="not once"):
        mutated(text, mutant)
