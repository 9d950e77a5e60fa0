"""How fast the guard stops, how seldom without cause, and how fast it lets go, with 5 % wild readings."""

from __future__ import annotations

from tests.loop.reaction import WILD_SHARE, drive, intrude, quantile
from tests.support.report import report

DRIVES = 100
INTRUSIONS = 200


def test_reaction() -> None:
    drives = [drive(seed) for seed in range(DRIVES)]
    intrusions = [intrude(seed) for seed in range(INTRUSIONS)]
    resumes = [each.resume for each in intrusions]
    figures = {
        "wild_share": WILD_SHARE,
        "drives": DRIVES,
        "drives_with_a_confirmed_stop": sum(each.confirmed > 0 for each in drives),
        "longest_stop_s": round(max(each.longest for each in drives), 3),
        "brief_dips_mean": sum(each.brief for each in drives) / DRIVES,
        "brief_dips_max": max(each.brief for each in drives),
        "intrusions": INTRUSIONS,
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
    assert figures["brief_dips_max"] <= 8
    assert figures["reaction_max_s"] <= 0.06
    assert figures["blocked_share"] >= 0.99
    assert figures["fastest_release_m_s"] <= 0.1 + 1e-9
    assert figures["resume_p95_s"] <= 0.7
    assert figures["resume_p99_s"] <= 0.9
    assert figures["contacts"] == 0
