"""`giraff dst`: what it prints and ends with."""

import json
from collections.abc import Iterable, Iterator

import pytest
from typer.testing import CliRunner

from giraff_cli.dst import explore as dst
from giraff_cli.main import app
from giraff_sim.dst import many
from giraff_sim.dst.judging.judge import Violation
from giraff_sim.dst.simulated_run import Outcome


def outcome(seed: int, *violations: Violation) -> Outcome:
    return Outcome(
        seed=seed,
        motion_digest=f"digest-{seed}",
        violations=violations,
        events=("  1.000 s  armed", "  2.000 s  VIOLATION (b): too old"),
        counts={"armed": 2, "fault: cut": 1, "stop: forward blocked": 3},
        path=1.5,
        near=0.5,
        contacts=0,
    )


@pytest.fixture
def third_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    def run_many(seeds: Iterable[int], jobs: int) -> Iterator[Outcome]:
        assert jobs == 1
        for seed in seeds:
            yield outcome(seed, *([Violation(2_000_000, "b", "too old")] if seed == 12 else []))

    monkeypatch.setattr(dst, "run_many", run_many)


@pytest.mark.usefixtures("third_fails")
def test_a_seed_that_fails_tells_its_story_and_how_to_have_it_again() -> None:
    ran = CliRunner().invoke(
        app, ["dst", "--seeds", "5", "--seed", "10", "--jobs", "1", "--json"], catch_exceptions=False
    )
    assert ran.exit_code == 1
    assert ran.stderr.count("VIOLATION (b): too old") == 1
    assert (
        f"motion digest-12, events {outcome(12).event_digest}; again with: giraff dst --seeds 1 --seed 12" in ran.stderr
    )
    assert "seeds: 5, 100 s simulated" in ran.stderr
    totals = json.loads(ran.stdout)
    assert totals["failures"] == [{"seed": 12, "violations": ["(b) too old"]}]
    assert totals["counts"] == {"armed": 10, "fault: cut": 5, "stop: forward blocked": 15}
    assert (totals["seeds"], totals["drove"], totals["path"]) == (5, 5, 7.5)


@pytest.mark.usefixtures("third_fails")
def test_seeds_that_hold_are_summed_up() -> None:
    ran = CliRunner().invoke(app, ["dst", "--seeds", "2", "--jobs", "1"], catch_exceptions=False)
    assert ran.exit_code == 0
    assert "armed\n" not in ran.output
    assert "no invariant is violated" in ran.output
    assert "2  cut" in ran.output
    assert "6  forward blocked" in ran.output
    assert "3 m, 1 m of it within half a metre of something" in " ".join(ran.output.split())
    never = ran.output.partition("never reached by these seeds")[2]
    assert "fault: kill" in never
    assert "answer: the disk hangs" in never
    assert "fault: cut" not in never
    assert "stop: forward blocked" not in never


def test_a_single_seed_is_really_run_and_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(many, "SECONDS", 6.0)
    ran = CliRunner().invoke(app, ["dst", "--seeds", "1", "--seed", "3", "--jobs", "1"], catch_exceptions=False)
    assert "s  armed" in ran.output
    assert "seeds: 1, 20 s simulated" in ran.output
