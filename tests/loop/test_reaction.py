"""Wild readings and people who step in, in simulated time: a part of what tests/campaign/test_reaction.py does."""

from tests.loop.reaction import drive, intrude

DIPS = 0
"""A seed whose wild readings cost dips."""
INTRUSION = 8
"""A seed. Of the first twelve, the robot takes longest to go on after this one and another one."""


def test_wild_readings_cost_brief_dips_and_nothing_else() -> None:
    figures = drive(DIPS, seconds=10.0)
    print(f"10 s: {figures.brief} brief dips")
    assert figures.confirmed == 0
    assert 0 < figures.brief <= 3
    assert figures.path > 2.0


def test_without_wild_readings_nothing_stops_a_free_robot() -> None:
    figures = drive(0, wild_share=0.0, seconds=5.0)
    assert (figures.confirmed, figures.brief) == (0, 0)


def test_who_steps_in_stops_the_robot_and_who_goes_lets_it_go_on() -> None:
    found = intrude(INTRUSION)
    print(f"stopped within {found.reaction:.3f} s, resumed in {found.resume:.2f} s")
    assert found.reaction <= 0.04
    assert found.blocked_turns >= 0.99 * found.turns
    assert found.fastest_release <= 0.1
    assert found.resume <= 0.9
    assert found.contacts == 0
