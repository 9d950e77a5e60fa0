"""A sample is checked once where it is made and once where it arrives, and not on its way."""

import math
import sys
from collections import Counter
from collections.abc import Callable
from types import FrameType
from typing import Any

import msgspec
import pytest

from giraff_schemas import messages as m
from giraff_schemas.codec import decode, encode, stamped
from giraff_schemas.topics import TOPICS, Topic
from tests.unit.schemas.samples import an_example

OURS = {
    f"giraff_schemas.{module}"
    for module in ("messages", "camera", "motion", "localization", "places", "scan", "checks")
}


def fields_of(sample: msgspec.Struct) -> dict[str, Any]:
    """As a maker gives them."""
    return {name: getattr(sample, name) for name in sample.__struct_fields__}


def a_sample(topic: Topic[Any]) -> Any:
    example = an_example(topic.schema)
    return msgspec.convert(example | ({topic.names: topic.name_in("some/key")} if topic.names else {}), topic.schema)


def calls_in(act: Callable[[], Any]) -> tuple[Any, Counter[str]]:
    """What `act` returns, and how often it called each function of the messages and their checks."""
    calls: Counter[str] = Counter()

    def count(frame: FrameType, event: str, _: object) -> None:
        if event == "call" and frame.f_globals.get("__name__") in OURS:
            calls[frame.f_code.co_name] += 1

    before = sys.getprofile()
    sys.setprofile(count)
    try:
        result = act()
    finally:
        sys.setprofile(before)
    return result, calls


@pytest.mark.parametrize("topic", TOPICS, ids=lambda topic: topic.key)
def test_a_sample_is_checked_once_on_each_side(topic: Topic[Any]) -> None:
    given_fields = fields_of(a_sample(topic))
    inner = [each for value in given_fields.values() for each in (value if isinstance(value, tuple) else (value,))]
    made, at_creation = calls_in(lambda: topic.schema(**given_fields))
    whole, at_stamping = calls_in(lambda: stamped(made, 3, 4, "a1"))
    payload, at_encoding = calls_in(lambda: encode(whole))
    got, at_arrival = calls_in(lambda: decode(topic, "some/key", payload))
    assert got == whole
    own = 1 if hasattr(topic.schema, "__post_init__") else 0
    assert at_creation["__post_init__"] == own
    assert not at_stamping
    assert not at_encoding
    checked = sum(isinstance(each, msgspec.Struct) and hasattr(type(each), "__post_init__") for each in inner)
    assert at_arrival["__post_init__"] == own + checked


def test_what_is_sound_costs_no_more_than_the_look_at_its_numbers() -> None:
    """In particular no names are put together, which most of an odometry sample's time once went into."""
    topic = next(topic for topic in TOPICS if topic.schema is m.Odometry)
    given_fields = fields_of(a_sample(topic))
    _, calls = calls_in(lambda: m.Odometry(**given_fields))
    assert calls == {"__post_init__": 1, "require_finite": 1}


def spoils(type_: type[msgspec.Struct]) -> list[tuple[str, dict[str, Any]]]:
    """Each number of a message that can be spoilt: its name, and the fields with NaN in it."""
    fields = fields_of(msgspec.convert(an_example(type_), type_))
    found = [(name, fields | {name: math.nan}) for name, value in fields.items() if isinstance(value, float)]
    for name, value in fields.items():
        if isinstance(value, tuple):
            if not all(isinstance(each, float) for each in value):
                continue
            spoilt = ((*value[:index], math.nan, *value[index + 1 :]) for index in range(len(value)))
            found += [(f"{name}[{index}]", fields | {name: each}) for index, each in enumerate(spoilt)]
    return found


MADE = [(topic.schema, name, fields) for topic in TOPICS for name, fields in spoils(topic.schema)]


def test_a_maker_cannot_make_what_is_not_finite() -> None:
    for type_, name, fields in MADE:
        with pytest.raises(ValueError, match="not a finite number") as refused:
            type_(**fields)
        assert str(refused.value).startswith(f"{name} is nan"), type_


def test_a_maker_cannot_make_a_verdict_that_is_not_finite() -> None:
    with pytest.raises(ValueError, match=r"^allowed is inf, not a finite number"):
        m.DirectionLimit(allowed=math.inf, clearance="free", sensor="")
