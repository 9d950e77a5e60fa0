"""A page's hand: what counts of what it says, for how long, and what ends it for good."""

from typing import Any

import pytest

from giraff_schemas.trouble import NO_TROUBLE
from giraff_web.config import WebConfig
from giraff_web.hand import SILENCE, WISH_LASTS
from giraff_web.messages import PageWish, moment
from tests.support.robots import ROBOT
from tests.unit.web.hands import Person


@pytest.fixture
def person() -> Person:
    """One that holds the pad and drives."""
    person = Person()
    person.wish()
    person.touch()
    person.wish(forward=1.0)
    assert person.is_holding()
    return person


def test_the_pad_asks_for_its_share_of_0_3_m_s_and_of_the_turn(person: Person) -> None:
    assert person.hand.asks == pytest.approx((0.3, 0.0))
    person.wish(left=-0.5)
    assert person.hand.asks == pytest.approx((0.0, -0.5 * 0.3 / ROBOT.max_wheel_speed * 1.57))


@pytest.mark.parametrize("slow", [0.1, 0.3])
def test_it_is_as_slow_as_it_is_told(slow: float) -> None:
    person = Person(WebConfig(slow_speed=slow))
    person.touch()
    person.wish(forward=-1.0)
    assert person.hand.asks == pytest.approx((-slow, 0.0))


def test_the_tick_is_the_pages_and_never_a_newer_one(person: Person) -> None:
    given = person.hand.tick
    assert given is not None
    assert given.robot_ns == person.tick.robot_ns - 30_000_000
    person.wait(0.2)
    assert person.hand.tick == given


def test_silence_ends_it_until_it_is_put_down_again(person: Person) -> None:
    person.wait(SILENCE)
    assert person.is_holding()
    person.wait(0.01)
    assert (person.is_holding(), person.hand.asks) == (False, (0.0, 0.0))
    assert "hold again" in str(person.hand.lost)
    person.wish(forward=1.0)
    assert (person.is_holding(), person.hand.asks) == (False, (0.0, 0.0))
    person.let_go()
    person.wish()
    assert person.hand.lost == NO_TROUBLE
    person.touch()
    assert person.is_holding()


def test_a_wish_of_old_ticks_ends_it(person: Person) -> None:
    """What comes down to the page stands still, and what goes up does not."""
    for age in (0.23, 0.4):
        person.wish(age - 0.03 if age < 0.3 else 0.17, tick_age=age, forward=1.0)
        assert person.is_holding()
    person.wish(0.01, tick_age=WISH_LASTS + 0.01, forward=1.0)
    assert not person.is_holding()
    assert "too old" in str(person.hand.lost)


@pytest.mark.parametrize(
    "wrong",
    [
        {"after": SILENCE + 0.1},
        {"after": 0.01, "tick_age": 0.2},
        {"input": "keys"},
        *({"tick": tick} for tick in (("8", "1"), None, ("0", "0"), ("7", "9" * 19), ("9" * 20, "1"))),
    ],
    ids=str,
)
def test_one_wish_that_is_wrong_ends_it(person: Person, wrong: dict[str, Any]) -> None:
    """As of a host that stood still, of another input, or with a tick that is behind, ahead, or nobody's."""
    person.wish(**wrong, forward=1.0)
    assert not person.is_holding()


def test_what_was_said_comes_again_and_says_nothing(person: Person) -> None:
    said = PageWish(n=person.n, tick=moment(person.tick), hold=person.hold, input="pad", forward=1.0)
    person.let_go()
    person.hand.on_wish(said, person.tick, person.now)
    assert (person.is_holding(), person.hand.asks) == (False, (0.0, 0.0))
    person.hand.on_wish(PageWish(n=person.n + 1, tick=said.tick, hold=said.hold, input="pad"), person.tick, person.now)
    assert not person.is_holding(), "a hold that has ended"


def test_what_was_said_in_this_hold_comes_again_and_says_nothing(person: Person) -> None:
    said = PageWish(n=person.n, tick=moment(person.hand.tick), hold=person.hold, input="pad", forward=1.0)
    person.wish(tick=said.tick)
    person.hand.on_wish(said, person.tick, person.now)
    assert (person.is_holding(), person.hand.asks) == (True, (0.0, 0.0))


def test_a_hold_that_begins_off_the_middle_never_counts() -> None:
    person = Person()
    person.touch(forward=0.4)
    assert not person.is_holding()
    assert person.hand.lost
    person.wish()
    person.wish(forward=0.4)
    assert not person.is_holding()


def test_a_finger_that_is_lifted_has_lost_nothing(person: Person) -> None:
    person.let_go()
    assert (person.is_holding(), person.hand.asks, person.hand.lost) == (False, (0.0, 0.0), NO_TROUBLE)


@pytest.mark.parametrize("why", ["cancelled", "hidden", "focus", "turned", "idle", "stalled", "left", "gamepad"])
def test_what_the_page_has_lost_is_told(person: Person, why: str) -> None:
    person.let_go(why)
    assert not person.is_holding()
    assert person.hand.lost.remedy == "let go, then hold again"


def test_an_end_that_comes_late_or_again_ends_nothing_new(person: Person) -> None:
    person.let_go()
    late = person.n
    person.touch()
    person.n = late - 1
    person.let_go()
    assert person.is_holding()
