"""A page's route: the page that has asked holds on to it with its own ticks, and whatever ends that ends the route."""

from itertools import count
from typing import Any
from unittest.mock import MagicMock

import msgspec
import pytest

from giraff_core.retry import RetriedRequest
from giraff_schemas.codec import stamped
from giraff_schemas.messages import RobotTime, Tick
from giraff_schemas.motion import NOWHERE, MotionAnswer, MotionHold, Stage
from giraff_schemas.places import NO_ROUTE, Goal, PlacesGo
from giraff_schemas.topics import PLACES_CANCEL, PLACES_GO, PLACES_HOLD, ROUTE, TICK
from giraff_schemas.trouble import Trouble
from giraff_web.config import WebConfig
from giraff_web.messages import Go, PageWish, Refused, Route, RouteCancel, RouteHold
from giraff_web.pages import Closed, Event, Opened, Said, StopAsked
from giraff_web.route import TOLD_FOR
from giraff_web.service import Web
from tests.support.robots import ROBOT

PHONE, LAPTOP, WATCHER = 1, 2, 3
TURN = 0.02


class _Asking(RetriedRequest[MotionAnswer]):
    def __init__(self, sent: list[tuple[str, Any]], asked: tuple[str, Any]) -> None:
        super().__init__(lambda _: True)
        self._sent, self._asked = sent, asked

    def _attempt(self) -> None:
        if self.attempts == 1:
            self._sent.append(self._asked)
            self.on_answer(MotionAnswer(accepted=True))


class Desk:
    """Two pages that may drive and one that watches, a robot that ticks, and a giraff_places that says yes."""

    def __init__(self) -> None:
        self.sent: list[tuple[str, Any]] = []
        self.holds: list[MotionHold] = []
        self.told: dict[int, list[Any]] = {PHONE: [], LAPTOP: [], WATCHER: []}
        self.now, self.turns = 10.0, 0
        self.samples: dict[str, list[Any]] = {TICK.key: [], ROUTE.key: []}
        self.pages = MagicMock()
        self.pages.send = lambda page, message: self.told[page].append(message)
        io = MagicMock(instance="me", hostname="desk", lost_parameters=Trouble())
        io.token = MagicMock(side_effect=count(1))
        io.inbox = lambda topic, *_, **__: MagicMock(pop_all=lambda: self.samples.pop(topic.key, []))
        io.publisher = lambda topic: MagicMock(put=self.holds.append) if topic is PLACES_HOLD else MagicMock()
        io.ask = lambda query, request, _: _Asking(self.sent, (query.key, request))
        self.web = Web(io, WebConfig(), ROBOT, self.pages, lambda _: None)
        self.turn(Opened(PHONE, "phone", True), Opened(LAPTOP, "laptop", True), Opened(WATCHER, "watcher", False))

    @property
    def moment(self) -> tuple[str, str]:
        """The tick that a page gives back now: one of a moment ago."""
        return "7", str(round((self.now - 0.03) * 1e9))

    def turn(self, *events: Event) -> None:
        self.now += TURN
        self.turns += 1
        self.samples[TICK.key] = [Tick(epoch=7, robot_ns=round(self.now * 1e9))]
        self.pages.poll.return_value = list(events)
        self.web.turn(self.now)

    def show(self) -> None:
        """As many turns as it takes to tell the pages."""
        for _ in range(3):
            self.turn()

    def say(self, page: int, *messages: Any) -> None:
        self.turn(*(Said(page, message) for message in messages))

    def go(self, page: int = PHONE, goal: Any = "kitchen") -> tuple[str, str]:
        """With which tick it asks."""
        tick = self.moment
        self.say(page, Go(n=1, tick=tick, goal=goal))
        self.tell("moving")
        self.turn()
        return tick

    def tell(self, stage: Stage, **changes: Any) -> None:
        """How giraff_places says that the route goes on."""
        known = {"id": 1, "by": "web@desk (phone)", "place": "kitchen", "goal": Goal(x=3.0, y=1.0), "stage": stage}
        state = msgspec.structs.replace(NO_ROUTE, **known | changes)
        self.samples[ROUTE.key] = [stamped(state, self.turns, 0, "places")]

    def asked(self, key: str) -> list[Any]:
        return [request for asked, request in self.sent if asked == key]

    @property
    def cancelled(self) -> list[int]:
        """Ids of the routes that were to end."""
        return [request.id for request in self.asked(PLACES_CANCEL.key)]


@pytest.fixture
def desk() -> Desk:
    return Desk()


def time_of(moment: tuple[str, str]) -> RobotTime:
    return RobotTime(epoch=int(moment[0]), robot_ns=int(moment[1]))


@pytest.mark.parametrize(("goal", "meant"), [("kitchen", "kitchen"), ((3.2, 1.5), Goal(x=3.2, y=1.5))])
def test_a_second_tap_asks_with_the_tick_of_its_page(desk: Desk, goal: Any, meant: str | Goal) -> None:
    tick = desk.go(goal=goal)
    (request,) = desk.asked(PLACES_GO.key)
    assert request == PlacesGo(by="web@desk (phone)", id=1, instance="me", tick=time_of(tick), goal=meant)


def test_the_hold_has_the_tick_of_the_page_and_ends_when_that_says_no_more(desk: Desk) -> None:
    ticks = [desk.go()]
    for _ in range(20):
        ticks.append(desk.moment)
        desk.say(PHONE, RouteHold(tick=ticks[-1]))
        desk.say(LAPTOP, RouteHold(tick=desk.moment))
        desk.tell("moving")
    said = [hold.tick for hold in desk.holds]
    assert len(said) > 18
    assert [tick for tick in map(time_of, ticks) if tick in said] == said
    for _ in range(30):
        desk.tell("moving")
        desk.turn()
    assert [hold.tick for hold in desk.holds][len(said) :] in ([], [time_of(ticks[-1])])
    (over,) = (message for message in desk.told[PHONE] if isinstance(message, Refused))
    assert over.why.what == "nothing was heard of the page, and its route ends"
    desk.say(PHONE, RouteHold(tick=desk.moment))
    desk.turn()
    assert desk.holds[-1].tick in [*said, time_of(ticks[-1])], "it has ended for good"


@pytest.mark.parametrize(
    "end",
    [
        Said(PHONE, RouteCancel(n=1)),
        Closed(PHONE),
        StopAsked("watcher"),
        Said(WATCHER, RouteCancel()),
        Said(PHONE, PageWish(n=1, tick=None, hold=1, input="pad")),
        Said(LAPTOP, PageWish(n=1, tick=None, hold=1, input="keys")),
    ],
    ids=["hidden", "closed", "emergency stop", "Stop on another page", "hand", "hand on another page"],
)
def test_it_is_cancelled_at_once(desk: Desk, end: Event) -> None:
    desk.go()
    assert desk.cancelled == []
    held = list(desk.holds)
    desk.turn(end)
    desk.say(PHONE, RouteHold(tick=desk.moment))
    assert (desk.cancelled, desk.holds) == ([1], held)


@pytest.mark.parametrize("said", [RouteCancel(n=1), PageWish(n=1, tick=None, hold=0, input="pad")])
def test_another_page_that_lets_go_or_holds_nothing_ends_nothing(desk: Desk, said: Any) -> None:
    desk.go()
    desk.say(LAPTOP, said)
    desk.turn(Closed(LAPTOP))
    assert desk.cancelled == []


def test_another_page_is_refused_and_told_who_has_asked(desk: Desk) -> None:
    desk.go()
    desk.go(LAPTOP)
    desk.say(WATCHER, Go(n=1, tick=desk.moment, goal="desk"))
    assert len(desk.asked(PLACES_GO.key)) == 1
    assert desk.told[LAPTOP][-1].why.what == "a route that phone has asked for goes on"
    assert not any(isinstance(message, Refused) for message in desk.told[PHONE] + desk.told[WATCHER])


def test_any_page_stops_a_route_that_somebody_else_has_asked_for(desk: Desk) -> None:
    desk.tell("moving", id=77, by="script@desk")
    desk.turn()
    desk.say(WATCHER, RouteCancel())
    desk.turn()
    assert desk.cancelled == [77]


def test_all_pages_see_what_is_left_of_the_way_and_its_end_for_a_while(desk: Desk) -> None:
    desk.go()
    way = {"asked": msgspec.structs.replace(NOWHERE, path=7.94), "achieved": msgspec.structs.replace(NOWHERE, path=3.2)}
    corners = tuple((float(number), 0.0) for number in range(5))
    desk.tell("moving", step=2, steps=4, corners=corners, **way)
    desk.show()
    shown = desk.told[WATCHER][-1]
    assert (shown.page, shown.goal, shown.end, shown.leg, shown.legs) == (PHONE, "kitchen", (3.0, 1.0), 2, 4)
    assert (shown.corners, shown.come, shown.way) == (corners[2:], 3.2, 7.9)
    desk.tell("ended", outcome="arrived", step=4, steps=4, corners=corners)
    desk.show()
    assert (desk.told[WATCHER][-1].stage, desk.told[WATCHER][-1].outcome) == ("ended", "arrived")
    told = len(desk.told[WATCHER])
    desk.show()
    assert len(desk.told[WATCHER]) == told
    desk.now += TOLD_FOR
    desk.show()
    assert desk.told[WATCHER][told:] == [Route()]
