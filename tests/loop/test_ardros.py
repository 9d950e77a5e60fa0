"""Two drawn Ardros robots of the twenty that tests/campaign/test_ardros.py drives."""

from __future__ import annotations

import pytest

from tests.loop.ardros import require_sound


@pytest.mark.parametrize("seed", range(2))
def test_a_drawn_ardros_does_what_it_is_asked_and_knows_where_it_is(seed: int) -> None:
    require_sound(seed)
