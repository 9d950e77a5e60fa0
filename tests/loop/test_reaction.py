"""Wild readings and people who step in, in simulated time: a part of what tests/campaign/test_reaction.py does."""

from __future__ import annotations

from tests.loop.reaction import drive, intrude

DRIVES = 6
INTRUSIONS = 12


def test_wild_readings_cost_brief_dips_and_nothing_else() -> None:
    drives = [drive(seed) for seed in range(DRIVES)]
    print(f"{DRIVES} drives of a minute: {[each.brief for each in drives]} brief dips")
    assert [each.confirmed for each in drives] == [0] * DRIVES
    assert 0 < max(each.brief for each in drives) <= 8
    assert min(each.path for each in drives) > 10.0


def test_without_wild_readings_nothing_stops_a_free_robot() -> None:
    figures = drive(0, wild_share=0.0, seconds=20.0)
    assert (figures.confirmed, figures.brief) == (0, 0)


def test_who_steps_in_stops_the_robot_and_who_goes_lets_it_go_on() -> None:
    intrusions = [intrude(seed) for seed in range(INTRUSIONS)]
    reaction = max(each.reaction for each in intrusions)
    resume = max(each.resume for each in intrusions)
    blocked = sum(each.blocked_turns for each in intrusions) / sum(each.turns for each in intrusions)
    print(f"{INTRUSIONS} intrusions: stopped within {reaction:.3f} s, blocked {blocked:.2%}, resumed in {resume:.2f} s")
    assert reaction <= 0.06
    assert blocked >= 0.99
    assert max(each.fastest_release for each in intrusions) <= 0.1
    assert resume <= 0.9
    assert sum(each.contacts for each in intrusions) == 0
