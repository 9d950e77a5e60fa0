"""Each safety rule broken once: the test that is named for it fails, and passes with the rule whole."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.campaign.records import judged, write_record
from tests.mutants.laboratory import Laboratory, Mutant, read_mutants

MUTANTS = read_mutants()


@pytest.fixture(scope="module")
def laboratory(tmp_path_factory: pytest.TempPathFactory) -> Laboratory:
    return Laboratory(tmp_path_factory.mktemp("laboratory"))


@pytest.fixture(scope="module")
def killed() -> Iterator[list[Mutant]]:
    """Those that were noticed; when all were, the record is written."""
    found: list[Mutant] = []
    yield found
    if len(found) == len(MUTANTS):
        killers = {mutant.rule: mutant.killed_by for mutant in found}
        broken = {mutant.file for mutant in MUTANTS}
        noticed_by = {mutant.killed_by.partition("::")[0] for mutant in MUTANTS}
        files = judged(__name__, also=("tests/mutants", *broken, *noticed_by))
        write_record("mutants", {"mutants": len(MUTANTS), "killed_by": killers}, files)


@pytest.mark.parametrize("killer", sorted({mutant.killed_by for mutant in MUTANTS}))
def test_with_all_rules_whole_it_passes(killer: str, laboratory: Laboratory) -> None:
    assert laboratory.passes(killer)


@pytest.mark.parametrize("mutant", MUTANTS, ids=lambda mutant: mutant.rule)
def test_a_broken_rule_is_noticed(mutant: Mutant, laboratory: Laboratory, killed: list[Mutant]) -> None:
    with laboratory.broken(mutant):
        assert not laboratory.passes(mutant.killed_by), f"nobody notices: {mutant.old!r} -> {mutant.new!r}"
    killed.append(mutant)
