"""What one page may take, and what waits of it for the service's turn."""

from giraff_web.event_box import EventBox
from giraff_web.limits import Rate, SendWindow
from giraff_web.messages import LetGo, PageWish, Reset, RouteHold
from giraff_web.pages import Closed, Event, Opened, Said, StopAsked


def wish(n: int, page: int = 1) -> Said:
    return Said(page, PageWish(n=n, tick=None, hold=0, input="pad"))


def let_go(n: int, page: int = 1) -> Said:
    return Said(page, LetGo(n=n, why="finger"))


def box(*events: Event) -> EventBox:
    it = EventBox()
    for event in events:
        it.put(event)
    return it


def test_a_page_gets_three_states_and_the_next_once_it_has_shown_one() -> None:
    credit = SendWindow()
    for n in (10, 11, 12):
        assert credit.allows()
        credit.sent(n, 0.0)
    assert not credit.allows()
    credit.seen(9, 0.1)
    assert not credit.allows()
    credit.seen(11, 0.2)
    credit.sent(30, 0.2)
    assert credit.allows()
    credit.sent(31, 0.2)
    assert not credit.allows()


def test_it_is_silent_from_when_it_was_sent_something_or_showed_something_last() -> None:
    credit = SendWindow()
    assert credit.waits(100.0) == 0.0
    credit.sent(1, 100.0)
    credit.sent(2, 101.0)
    assert credit.waits(103.0) == 3.0
    credit.seen(1, 103.0)
    assert credit.waits(104.0) == 1.0
    credit.seen(2, 104.0)
    assert credit.waits(200.0) == 0.0


def test_so_many_messages_a_second_and_as_many_at_once() -> None:
    rate = Rate(250.0, 0.0)
    assert sum(rate.admit(0.0) for _ in range(1000)) == 250
    assert sum(rate.admit(0.1) for _ in range(1000)) == 25
    assert sum(rate.admit(100.0) for _ in range(1000)) == 250


def test_events_come_in_their_order_and_once() -> None:
    events = (Opened(1, "phone", may_drive=True), wish(1), StopAsked("phone"), wish(2), let_go(3), Opened(2, "", False))
    it = box(*events)
    assert list(it.pop_all()) == list(events)
    assert list(it.pop_all()) == []


def test_of_a_flood_of_wishes_the_oldest_go_and_nothing_else() -> None:
    it = box(let_go(0), StopAsked("a"), *map(wish, range(1, 1000)), StopAsked("b"), wish(7, page=2))
    taken = list(it.pop_all())
    assert taken[:2] == [let_go(0), StopAsked("a")]
    assert taken[2:-2] == [wish(n) for n in range(968, 1000)]
    assert taken[-2:] == [StopAsked("b"), wish(7, page=2)]


def test_a_flood_of_anything_takes_no_more_room() -> None:
    it = EventBox()
    for n in range(5000):
        reset, hold = Reset(id="1", engaged_ns="1", tick=None), RouteHold(tick=("1", "1"))
        for event in (wish(n), let_go(n), Said(1, reset), Said(1, hold), StopAsked(str(n))):
            it.put(event)
    assert len(it) == 32 + 8 + 64
    assert sum(isinstance(event, StopAsked) for event in it.pop_all()) == 64


def test_pages_that_come_and_go_take_no_room() -> None:
    it = EventBox()
    for page in range(1, 5000):
        it.put(Opened(page, "", may_drive=True))
        it.put(wish(1, page))
        it.put(Closed(page))
    assert (len(it), len(it._pages)) == (0, 0)


def test_what_a_page_said_last_goes_with_it_and_a_stop_stays() -> None:
    it = box(Opened(1, "", may_drive=True))
    list(it.pop_all())
    for event in (wish(1), StopAsked("phone"), Closed(1)):
        it.put(event)
    assert list(it.pop_all()) == [StopAsked("phone"), Closed(1)]
