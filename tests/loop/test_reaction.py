"""Wild readings and people who step in, in simulated time: a part of what tests/campaign/test_reaction.py does."""

from __future__ import annotations

from tests.loop.reaction import drive, intrude

DIPS = 0
"""A seed whose wild readings cost dips."""
INTRUSIONS = (8, 11)
"""Of the first twelve those after which the robot takes longest to go on."""


def test_wild_readings_cost_brief_dips_and_nothing_else() -> None:
    figures = drive(DIPS, seconds=20.0)
    print(f"20 s: {figures.brief} brief dips")
    assert figures.confirmed == 0
    assert 0 < figures.brief <= 3
    assert figures.path > 4.0


def test_without_wild_readings_nothing_stops_a_free_robot() -> None:
    figures = drive(0, wild_share=0.0, seconds=20.0)
    assert (figures.confirmed, figures.brief) == (0, 0)


def test_who_steps_in_stops_the_robot_and_who_goes_lets_it_go_on() -> None:
    intrusions = [intrude(seed) for seed in INTRUSIONS]
    reaction = max(each.reaction for each in intrusions)
    resume = max(each.resume for each in intrusions)
    blocked = sum(each.blocked_turns for each in intrusions) / sum(each.turns for each in intrusions)
    print(f"intrusions: stopped within {reaction:.3f} s, blocked {blocked:.2%}, resumed in {resume:.2f} s")
    assert reaction <= 0.04
    assert blocked >= 0.99
    assert max(each.fastest_release for each in intrusions) <= 0.1
    assert resume <= 0.9
    assert sum(each.contacts for each in intrusions) == 0
