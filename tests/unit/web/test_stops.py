"""STOP on a page: never refused nor put off, and its release is base's to judge."""

from collections.abc import Callable

import pytest

from giraff_schemas.messages import EStop, RobotTime
from giraff_schemas.requests import EStopAnswer, EStopReset
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_web.stops import Stops

RESET = EStopReset(by="web@host (phone)", id=4, tick=RobotTime(epoch=7, robot_ns=1), engaged_ns=9)
STOPPED = EStopAnswer(done=True, engaged=True, id=4, instance="base")
RELEASED = EStopAnswer(done=True, engaged=False, id=4)
REFUSED = EStopAnswer(done=False, engaged=True, id=5, reason=Trouble("there is another stop now"))


class Asked:
    """A request to a base that answers what it is told to."""

    refusal = None
    fault = "nobody answers"

    def __init__(self, what: str | EStopReset) -> None:
        self.what = what
        self.attempts = 0
        self.answer: EStopAnswer | None = None
        self.settles: Callable[[EStopAnswer], bool | str] = lambda _: True

    def poll(self, now: float) -> EStopAnswer | None:
        del now
        self.attempts += 1
        return self.answer if self.answer is not None and self.settles(self.answer) is True else None


class Base:
    """What is asked of it, and what was logged."""

    def __init__(self) -> None:
        self.asked: list[Asked] = []
        self.log: list[str] = []
        self.stops = Stops(self.engage, self.ask, self.log.append, is_open=False)

    def engage(self, device: str, settles: Callable[[EStopAnswer], bool | str], off: bool) -> Asked:
        asked = self.ask(f"{device}, off" if off else device)
        asked.settles = settles
        return asked

    def ask(self, what: str | EStopReset) -> Asked:
        self.asked.append(Asked(what))
        return self.asked[-1]

    def says(self, now: float, *, engaged: bool, base: str = "base", off: bool = False) -> None:
        state = EStop(instance=base, engaged=engaged, id=4, by="x", reason=Trouble("y"), engaged_ns=9, off=off)
        self.stops.on_estop(state, now)


@pytest.fixture
def base() -> Base:
    return Base()


def test_it_asks_until_base_confirms(base: Base) -> None:
    base.stops.stop("phone", 0.0)
    assert [asked.what for asked in base.asked] == ["phone"]
    for n in range(5):
        assert not base.stops.poll(n * 0.1)
    assert "NOT CONFIRMED" in base.stops.outcome.what
    assert "battery switch" in base.stops.outcome.remedy
    base.asked[0].answer = STOPPED
    assert not base.stops.poll(1.0)
    base.says(1.0, engaged=True)
    assert base.stops.poll(1.0)
    assert not base.stops.asked


def test_while_it_is_latched_further_ones_are_answered_by_bases_state(base: Base) -> None:
    base.says(0.0, engaged=True)
    for n in range(100):
        base.stops.stop("phone", n * 0.01)
    assert base.asked == []
    assert not base.stops.asked


def test_a_stop_is_confirmed_when_base_says_that_it_stands_and_never_by_an_old_word(base: Base) -> None:
    base.says(0.0, engaged=False)
    base.stops.stop("phone", 0.1)
    base.says(0.2, engaged=True)
    base.stops.poll(0.2)
    assert base.stops.confirmed(0.2) is None, "the request has no answer yet"
    base.asked[0].answer = STOPPED
    base.stops.poll(0.3)
    word = base.stops.confirmed(0.3)
    assert word is not None
    assert (word.engaged, word.id) == (True, 4)
    assert base.stops.confirmed(0.4) is None
    base.says(0.5, engaged=True)
    assert base.stops.confirmed(0.5) is not None
    base.says(0.6, engaged=False, base="other")
    assert base.stops.confirmed(0.6) is None


def test_a_stop_that_meets_a_reset_on_its_way_is_asked_for_after_all(base: Base) -> None:
    base.says(0.0, engaged=True)
    base.stops.stop("phone", 0.1)
    base.says(0.2, engaged=False)
    assert [asked.what for asked in base.asked] == ["phone"]
    base.says(0.3, engaged=False)
    assert len(base.asked) == 1


@pytest.mark.parametrize("heard", [0.2, 2.0, 9.0])
def test_one_that_base_is_silent_about_stands_until_it_is_heard(base: Base, heard: float) -> None:
    """The word that answered it may be of before a release: the link was cut, or base's disk was slow."""
    base.says(0.0, engaged=True)
    base.stops.stop("phone", 0.1)
    base.says(heard, engaged=False)
    assert [asked.what for asked in base.asked] == ["phone"]


def test_one_that_was_answered_does_not_stop_what_is_released_later(base: Base) -> None:
    base.says(0.0, engaged=True)
    base.stops.stop("phone", 0.1)
    base.says(2.7, engaged=True)
    base.says(3.0, engaged=False)
    assert base.asked == []


@pytest.mark.parametrize(("again", "asked"), [("phone", 1), ("laptop", 2)])
def test_a_page_says_each_stop_twice_and_whoever_saw_it_may_release_it(base: Base, again: str, asked: int) -> None:
    base.stops.stop("phone", 0.0)
    base.asked[0].answer = STOPPED
    base.says(0.1, engaged=True)
    base.stops.poll(0.1)
    base.stops.stop(again, 0.2)
    base.says(0.8, engaged=False)
    assert len(base.asked) == asked


def test_who_releases_on_a_page_knows_of_the_stop(base: Base) -> None:
    base.says(0.0, engaged=True)
    base.stops.stop("phone", 0.1)
    base.stops.reset("phone", RESET, 0.5)
    base.says(0.6, engaged=False)
    assert [asked.what for asked in base.asked] == [RESET]


def test_what_is_told_of_a_release_goes_with_the_stop(base: Base) -> None:
    base.says(0.0, engaged=True)
    base.stops.reset("phone", RESET, 0.0)
    base.asked[0].answer = REFUSED
    base.stops.poll(0.1)
    assert base.stops.outcome
    base.says(1.0, engaged=False)
    assert base.stops.outcome == NO_TROUBLE


@pytest.mark.parametrize("age", [0.0, 2.0])
def test_what_base_said_long_ago_or_one_of_two_bases_answers_nothing(base: Base, age: float) -> None:
    base.says(0.0, engaged=True)
    if not age:
        base.says(0.0, engaged=False, base="other")
    base.stops.stop("phone", age)
    assert len(base.asked) == 1


def test_no_number_of_stops_is_too_many(base: Base) -> None:
    for n in range(250):
        base.stops.stop("phone", n * 0.01)
        base.asked[-1].answer, base.asked[-1].settles = STOPPED, lambda _: True
        base.stops.poll(n * 0.01)
    assert len(base.asked) == 250


def test_a_release_names_what_was_shown_and_tells_what_base_says(base: Base) -> None:
    base.stops.reset("phone", RESET, 0.0)
    assert base.asked[0].what == RESET
    base.stops.poll(0.0)
    assert "not confirmed" in base.stops.outcome.what
    base.asked[0].answer = REFUSED
    base.stops.poll(0.1)
    assert base.stops.outcome == Trouble("STILL STOPPED: there is another stop now")
    base.stops.reset("phone", RESET, 0.1)
    base.asked[1].answer = RELEASED
    base.stops.poll(0.2)
    assert base.stops.outcome == NO_TROUBLE


def test_who_wants_a_stop_wants_no_release_any_more(base: Base) -> None:
    base.stops.reset("phone", RESET, 0.0)
    base.stops.stop("laptop", 0.0)
    base.stops.poll(0.0)
    assert base.asked[0].attempts == 0
    base.stops.reset("phone", RESET, 0.0)
    assert len(base.asked) == 2, "a stop is not confirmed yet"


@pytest.mark.parametrize("knows_off", [True, False])
def test_off_is_asked_for_under_a_stop_too_until_base_has_answered(base: Base, knows_off: bool) -> None:
    base.says(0.0, engaged=True)
    base.stops.stop("phone", 0.1)
    assert base.asked == []
    for n in range(3):
        base.stops.stop("phone", 0.2 + n * 0.1, off=True)
        assert "SWITCHING OFF, NOT CONFIRMED" in base.stops.outcome.what
    base.asked[0].answer = STOPPED
    base.says(0.5, engaged=True, off=knows_off)
    assert base.stops.poll(0.5)
    word = base.stops.confirmed(0.5)
    assert word is not None
    assert word.off == knows_off
    assert ("STOPPED, not off: this robot's drive has no other off" in base.stops.outcome.what) != knows_off
    base.stops.stop("phone", 0.6, off=True)
    assert [asked.what for asked in base.asked] == ["phone, off"]
    base.says(3.0, engaged=True, off=knows_off)
    base.says(3.1, engaged=False)
    assert base.stops.outcome == NO_TROUBLE


def test_off_takes_the_place_of_a_stop_that_is_not_confirmed(base: Base) -> None:
    base.stops.stop("phone", 0.0)
    base.stops.stop("phone", 2.0, off=True)
    base.stops.stop("laptop", 2.1)
    assert [asked.what for asked in base.asked] == ["phone", "phone, off"]
