"""Drives through a flat and a room, looked for on their maps: how far off, how sure, and how often both are wrong."""

import math
from collections.abc import Callable, Iterator
from functools import cache
from typing import Final

import pytest

from tests.campaign.localization import verdicts
from tests.loop.localization.judging import Run, Verdict, line
from tests.support.report import report

SEEDS: Final = range(12)
FIRST_WITHIN: Final = 30.0  # m
QUIET_WITHIN: Final = 5.0  # m
AGAIN_WITHIN: Final = 40.0  # m
DOUBTS_WITHIN: Final = 45.0  # m: it looks for 40 m first
_JUDGED: Final = (
    *("track", "track_room", "global", "furniture", "person", "deaf", "kidnapped", "twin"),
    *("twin_long", "turned", "wrong", "wrong_room"),
)


@pytest.fixture(scope="module")
def found() -> Iterator[Callable[[str], Verdict]]:
    """The verdict about a kind of drives, which are made when a test first asks for it."""
    figures: dict[str, object] = {}

    @cache
    def judged(name: str) -> Verdict:
        [(_, verdict, runs)] = verdicts((name,), SEEDS)
        print(line(name, verdict))
        figures[name] = _figures(verdict) | {"each": [_told(run) for run in runs]}
        return verdict

    yield judged
    report("campaign/localization", figures)


def _figures(verdict: Verdict) -> dict[str, object]:
    return {
        name: round(value, 4) if isinstance(value, float) and math.isfinite(value) else value
        for name, value in verdict._asdict().items()
    }


def _told(run: Run) -> dict[str, object]:
    """What somebody wants of one drive who looks for the bad ones."""
    kidnapped = {} if run.kidnapped_at is None else {"quiet": run.quiet, "again": run.again}
    return {"seed": run.seed, "first": run.first, "wrong": len(run.wrong), **kidnapped}


@pytest.mark.parametrize("kind", ["track", "track_room"])
def test_it_follows_a_robot_whose_place_is_known(found: Callable[[str], Verdict], kind: str) -> None:
    verdict = found(kind)
    assert verdict.median <= 0.10
    assert verdict.p95 <= 0.25
    assert verdict.localized >= 0.85


def test_it_finds_a_robot_anywhere_in_a_flat(found: Callable[[str], Verdict]) -> None:
    assert found("global").first_longest <= FIRST_WITHIN


@pytest.mark.parametrize("kind", [kind for kind in _JUDGED if not kind.startswith("wrong")])
def test_it_never_says_that_it_knows_and_does_not(found: Callable[[str], Verdict], kind: str) -> None:
    assert found(kind).wrong_runs == ()


@pytest.mark.parametrize("kind", ["twin", "twin_long", "turned"])
def test_it_says_that_one_of_two_equal_places_may_be_the_other(found: Callable[[str], Verdict], kind: str) -> None:
    verdict = found(kind)
    assert verdict.localized == 0.0
    assert verdict.ambiguous >= 0.5
    assert verdict.near_while_ambiguous >= 0.95


def test_it_finds_a_kidnapped_robot_again(found: Callable[[str], Verdict]) -> None:
    verdict = found("kidnapped")
    assert verdict.quiet_longest <= QUIET_WITHIN
    assert verdict.again_longest <= AGAIN_WITHIN


@pytest.mark.parametrize("kind", ["person", "furniture", "deaf"])
def test_it_bears_what_is_not_on_the_map(found: Callable[[str], Verdict], kind: str) -> None:
    verdict = found(kind)
    assert verdict.p95 <= 0.4
    assert verdict.localized >= 0.5


@pytest.mark.parametrize("kind", ["wrong", "wrong_room"])
def test_it_doubts_a_map_of_elsewhere(found: Callable[[str], Verdict], kind: str) -> None:
    verdict = found(kind)
    assert verdict.localized == 0.0
    assert verdict.doubts_longest <= DOUBTS_WITHIN
