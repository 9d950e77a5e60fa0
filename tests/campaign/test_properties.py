"""What holds of any events, by a thousand random examples: `make test` tries few of them, and always the same."""

from collections.abc import Callable
from typing import Any, Final

import pytest
from hypothesis import settings

from tests.unit.base import test_any_events as base
from tests.unit.guard import test_any_events as guard
from tests.unit.guard import test_approach as approach
from tests.unit.guard import test_obstacles as obstacles

EXAMPLES: Final = settings(max_examples=1_000, derandomize=False)
PROPERTIES: Final[tuple[Callable[[], Any], ...]] = (
    base.test_whatever_happens_only_an_armed_robot_with_fresh_commands_moves,
    guard.test_only_the_holders_fresh_hand_ever_moves_or_arms,
    approach.test_no_approach_enters_the_margin,
    approach.test_not_even_where_the_geometry_leaves_no_slack,
    obstacles.test_whatever_comes_in_no_more_comes_out_than_was_asked,
)


@pytest.mark.parametrize("holds", PROPERTIES, ids=lambda holds: holds.__name__)
def test_it_holds_of_random_examples(holds: Callable[[], Any], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(holds, "_hypothesis_internal_use_settings", EXAMPLES)  # what `settings` itself sets
    holds()
