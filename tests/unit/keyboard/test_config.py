"""What the table [keyboard] may say."""

import msgspec
import pytest

from giraff_keyboard.config import KeyboardConfig


def test_the_defaults_are_valid() -> None:
    assert msgspec.convert({}, KeyboardConfig) == KeyboardConfig()


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ({"operator": "a/b"}, "cannot be part of a key"),
        ({"steps": 0}, "steps is 0: it must be within 1..100"),
        ({"first_step": 0}, "first_step is 0"),
        ({"first_step": 6}, "first_step is 6 and steps 5"),
        ({"speed": 1.0}, "unknown field `speed`"),
    ],
)
def test_a_senseless_value_is_refused_in_clear_words(table: dict[str, object], words: str) -> None:
    with pytest.raises(msgspec.ValidationError, match=words):
        msgspec.convert(table, KeyboardConfig)
