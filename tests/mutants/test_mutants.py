"""Each rule broken once: the test that is named for it fails, and passes with the rule whole."""

from __future__ import annotations

import pytest

from tests.mutants.laboratory import Laboratory, Mutant


@pytest.fixture(scope="module")
def laboratory(tmp_path_factory: pytest.TempPathFactory) -> Laboratory:
    return Laboratory(tmp_path_factory.mktemp("laboratory"))


def test_a_broken_rule_is_noticed(mutant: Mutant, laboratory: Laboratory) -> None:
    assert laboratory.passes_whole(mutant.killed_by), "it fails with all rules whole"
    with laboratory.broken(mutant):
        assert not laboratory.passes(mutant.killed_by), f"nobody notices: {mutant.old!r} -> {mutant.new!r}"
