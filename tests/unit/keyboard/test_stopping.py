"""The space bar's request: repeated until base says that it has stopped."""

from collections.abc import Callable

import msgspec
import pytest

from giraff_core.estop.request import EStopRequest
from giraff_keyboard.keys import StopHold
from giraff_schemas.messages import EStop
from giraff_schemas.requests import EStopAnswer
from giraff_schemas.trouble import NO_TROUBLE, Trouble


class Line:
    """Requests to a base that does not answer before it is told to."""

    def __init__(self) -> None:
        self.requests = 0
        self.attempts = 0
        self.fault = ""
        self.refusal: EStopAnswer | None = None
        self.answer: EStopAnswer | None = None

    def ask(self, settles: Callable[[EStopAnswer], bool | str], off: bool) -> "Line":
        assert not off
        self.requests += 1
        self.attempts = 0
        self.settles = settles
        return self

    def poll(self, now: float) -> EStopAnswer | None:
        del now
        self.attempts += 1
        if self.answer is None:
            return None
        judgement = self.settles(self.answer)
        self.fault = judgement if isinstance(judgement, str) else ""
        return self.answer if judgement is True else None


STOPPED = EStopAnswer(done=True, engaged=True, id=4, instance="base-1")
STATED = EStop(instance="base-1", engaged=True, id=4, by="me", reason=Trouble("space bar"))


def test_nothing_is_asked_before_the_space_bar() -> None:
    line = Line()
    stopping = EStopRequest(line.ask, is_open=False)
    assert not stopping.poll(0.0)
    assert (line.requests, stopping.asked, stopping.outcome) == (0, False, NO_TROUBLE)


@pytest.mark.parametrize(
    ("is_open", "unheard", "says"),
    [
        (False, 0.0, "STOPPED: base has confirmed"),
        (True, 0.0, "STOPPED, by the word of whoever answers as its base on this open network"),
        (False, 2.0, "ASKED TO STOP: base has confirmed; its board is not heard, and stops by itself within 2 s"),
    ],
)
def test_it_asks_until_base_confirms(is_open: bool, unheard: float, says: str) -> None:
    line = Line()
    stopping = EStopRequest(line.ask, is_open=is_open)
    stopping.engage()
    assert "NOT CONFIRMED" in str(stopping.outcome)
    line.fault = "estop/engage: nobody there"
    for turn in range(50):
        assert not stopping.poll(turn * 0.03)
        assert stopping.asked
    assert "NOT CONFIRMED after 50 requests: estop/engage: nobody there" in str(stopping.outcome)
    assert "battery switch" in str(stopping.outcome)
    line.answer = msgspec.structs.replace(STOPPED, unheard_stops_s=unheard)
    assert not stopping.poll(2.0)
    assert "after 51 requests: an answer says that latch 4 is engaged, but no estop" in str(stopping.outcome)
    stopping.on_sample(STATED)
    assert stopping.poll(2.0)
    assert not stopping.asked
    assert stopping.outcome == Trouble(says, action="release")
    assert not stopping.poll(2.1)


def test_an_answer_that_does_not_confirm_is_told_and_asked_again() -> None:
    line = Line()
    stopping = EStopRequest(line.ask, is_open=False)
    stopping.engage()
    line.refusal = EStopAnswer(done=False, engaged=True, id=4, reason=Trouble("disk full"))
    for turn in range(21):
        assert not stopping.poll(turn * 0.05)
        assert stopping.asked
    assert "NOT CONFIRMED after 21 requests: base answers: disk full" in str(stopping.outcome)


def test_pressed_again_while_asking_it_is_one_request() -> None:
    line = Line()
    stopping = EStopRequest(line.ask, is_open=False)
    for _ in range(5):
        stopping.engage()
        stopping.poll(0.0)
    assert line.requests == 1


def test_it_can_stop_again_after_a_reset() -> None:
    line = Line()
    stopping = EStopRequest(line.ask, is_open=False)
    line.answer = STOPPED
    stopping.engage()
    stopping.on_sample(STATED)
    assert stopping.poll(0.0)
    assert stopping.outcome
    stopping.on_sample(EStop(engaged=False, id=4, by="you"))
    assert not stopping.outcome
    stopping.engage()
    stopping.on_sample(EStop(engaged=False, id=4, by="you"))
    assert "NOT CONFIRMED" in str(stopping.outcome)
    assert not stopping.poll(0.9), "base has said so of the stop before"
    stopping.on_sample(STATED)
    assert stopping.poll(1.0)


def held(*times: float) -> list[float]:
    """Return when the space bar counts as held, of presses and repeats at these times."""
    hold = StopHold()
    return [now for now in times if hold.on_stop(now)]


@pytest.mark.parametrize(("delay", "period"), [(0.25, 0.02), (0.5, 0.033), (0.66, 0.04), (0.5, 0.092), (1.0, 0.1)])
def test_a_held_space_bar_asks_for_off_after_two_seconds(delay: float, period: float) -> None:
    times = [7.0, *(7.0 + delay + n * period for n in range(200))]
    assert held(*times)[0] - 7.0 == pytest.approx(2.0, abs=1.5 * period)


def test_however_often_it_is_pressed_that_is_no_hold() -> None:
    assert held(*(n * 0.125 for n in range(200))) == [], "hammered"
    assert held(*(n * 0.9 for n in range(20))) == []
    assert held(*(n + 0.05 * k for n in range(20) for k in range(10))) == [], "touched again and again"
    assert held(*[3.0] * 500) == [], "pasted"
