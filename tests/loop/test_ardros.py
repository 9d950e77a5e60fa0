"""One drawn Ardros of the twenty that tests/campaign/test_ardros.py drives."""

from tests.loop.ardros import require_sound


def test_a_drawn_ardros_does_what_it_is_asked_and_knows_where_it_is() -> None:
    require_sound(1)
