"""How fast the guard stops, how seldom without cause, and how fast it lets go, with 5 % wild readings."""

from collections.abc import Iterator

import pytest

from tests.loop.reaction import WILD_SHARE, DriveFigures, Intrusion, drive, intrude, quantile
from tests.support.report import report

DRIVES = 100
INTRUSIONS = 200
LEGS = 10


@pytest.fixture(scope="module")
def made() -> Iterator[tuple[list[DriveFigures], list[Intrusion]]]:
    """What all legs that ran came to; most of it is judged together."""
    drives: list[DriveFigures] = []
    intrusions: list[Intrusion] = []
    yield drives, intrusions
    resumes = [each.resume for each in intrusions]
    figures = {
        "wild_share": WILD_SHARE,
        "drives": len(drives),
        "drives_with_a_confirmed_stop": sum(each.confirmed > 0 for each in drives),
        "longest_stop_s": round(max(each.longest for each in drives), 3),
        "brief_dips_mean": sum(each.brief for each in drives) / len(drives),
        "brief_dips_max": max(each.brief for each in drives),
        "intrusions": len(intrusions),
        "reaction_max_s": round(max(each.reaction for each in intrusions), 3),
        "blocked_share": sum(each.blocked_turns for each in intrusions) / sum(each.turns for each in intrusions),
        "fastest_release_m_s": max(each.fastest_release for each in intrusions),
        "resume_p95_s": round(quantile(resumes, 0.95), 3),
        "resume_p99_s": round(quantile(resumes, 0.99), 3),
        "resume_max_s": round(max(resumes), 3),
        "contacts": sum(each.contacts for each in intrusions),
    }
    report("campaign/reaction", figures)
    assert figures["drives_with_a_confirmed_stop"] <= 3
    assert figures["blocked_share"] >= 0.99
    if len(intrusions) == INTRUSIONS:  # a quantile of few says nothing
        assert figures["resume_p95_s"] <= 0.7
        assert figures["resume_p99_s"] <= 0.9


@pytest.mark.parametrize("leg", range(LEGS))
def test_reaction(leg: int, made: tuple[list[DriveFigures], list[Intrusion]]) -> None:
    drives = [drive(seed) for seed in range(leg, DRIVES, LEGS)]
    intrusions = [intrude(seed) for seed in range(leg, INTRUSIONS, LEGS)]
    made[0].extend(drives)
    made[1].extend(intrusions)
    assert max(each.brief for each in drives) <= 8
    assert max(each.reaction for each in intrusions) <= 0.06
    assert max(each.fastest_release for each in intrusions) <= 0.1 + 1e-9
    assert sum(each.contacts for each in intrusions) == 0
