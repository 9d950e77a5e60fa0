"""Each rule broken once: the test that is named for it fails, and passes with the rule whole."""

import pytest

from tests.mutants.laboratory import Laboratory, Mutant


@pytest.fixture(scope="module")
def laboratory(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Laboratory:
    """One in which every killer of the mutants to be tried passes with all rules whole."""
    made = Laboratory(tmp_path_factory.mktemp("laboratory"))
    tried = (item for item in request.session.items if isinstance(item, pytest.Function) and hasattr(item, "callspec"))
    mutants = (item.callspec.params.get("mutant") for item in tried)
    made.require_whole(mutant.killed_by for mutant in mutants if isinstance(mutant, Mutant))
    return made


def test_a_broken_rule_is_noticed(mutant: Mutant, laboratory: Laboratory) -> None:
    with laboratory.broken(mutant):
        assert not laboratory.passes(mutant.killed_by), f"nobody notices: {mutant.old!r} -> {mutant.new!r}"
