"""Routes that pages ask for and hold on to, one at a time, and the route that all pages are shown. No clock.

A hold carries the tick that its page has heard. So the route of a page that is hidden, frozen or cut off ends as that
of a requester that has died, whatever this service does.
"""

import math
from collections.abc import Callable
from typing import Any, Final, NamedTuple

from giraff_core.io import IO
from giraff_core.latest import is_fresh
from giraff_core.motion.requester import HeldMotion, MotionRequester
from giraff_core.motion.wish import RouteWish
from giraff_core.retry import RetriedRequest
from giraff_schemas.messages import Tick
from giraff_schemas.motion import MotionAnswer, MotionCancel
from giraff_schemas.places import Goal, RouteState
from giraff_schemas.topics import PLACES_CANCEL, PLACES_HOLD, ROUTE, Query
from giraff_schemas.trouble import Trouble
from giraff_web.hand import time_of
from giraff_web.messages import Go, Moment, Refused, Route, RouteHold, Spot

TOLD_FOR: Final = 30.0
"""s for which the end of a route is shown."""
BEGINS_WITHIN: Final = 3.0
"""s in which a route can begin: this service's own lease ends 1 s after its hand has let go of it."""
_UNHEARD: Final = Trouble(
    "nothing was heard of the page, and its route ends", "check the wireless network, then ask again"
)
_NO_TICK: Final = Trouble("the page has not heard the robot", "ask again")
_LATE: Final = Trouble(f"the route could not begin within {BEGINS_WITHIN:g} s", "ask again")


class _Wish(NamedTuple):
    page: int
    device: str
    n: int
    id: int
    goal: Spot
    at: float
    """s, when it was asked for."""
    requester: MotionRequester
    motion: HeldMotion


class PageRoutes:
    """Times are monotonic, s."""

    def __init__(self, io: IO, by: str, tell: Callable[[int, Refused], object], log: Callable[[str], object]) -> None:
        """`by`: who asks, for people; `tell`: takes why a page's route is over."""
        self._io, self._by, self._tell, self._log = io, by, tell, log
        self._holds = io.publisher(PLACES_HOLD)
        self._wish: _Wish | None = None
        self._newest: tuple[int, int, int] = 0, 0, 0
        """Page, number of its `Go` and id of the newest wish."""
        self._state: RouteState | None = None
        self._heard = self._ended = -math.inf
        self._cancelling: RetriedRequest[MotionAnswer] | None = None
        """Cancels a route that somebody else has asked for."""

    def go(self, page: int, device: str, asked: Go, driver: Trouble, now: float) -> None:
        """Begin a route. `driver`: who drives by a hand, and what to do then."""
        tick = _tick(asked.tick)
        if self._wish is not None:
            other = f"a route that {self._wish.device} has asked for goes on"
            driver = Trouble(other, "wait until it has ended, or press its Stop")
        if driver or tick is None:
            self._tell(page, Refused(why=driver or _NO_TICK, route=True))
            return
        goal = asked.goal if isinstance(asked.goal, str) else Goal(x=asked.goal[0], y=asked.goal[1])
        id_ = self._io.token()
        requester = MotionRequester(id_, RouteWish(goal), f"{self._by} ({device})", self._io.instance)
        requester.on_tick(tick, now)
        motion = HeldMotion(requester, self._ask, self._holds.put)
        self._wish = _Wish(page, device, asked.n, id_, asked.goal, now, requester, motion)
        self._newest = page, asked.n, id_
        self._log(f"{device} asks for a route to {asked.goal}")

    def on_hold(self, page: int, said: RouteHold, now: float) -> None:
        """Take that a page holds on. Nobody holds another page's route."""
        if self._wish is not None and self._wish.page == page and (tick := _tick(said.tick)) is not None:
            self._wish.requester.on_tick(tick, now)

    def on_state(self, state: RouteState, now: float) -> None:
        """Take how a route goes on, whoever has asked for it."""
        before, self._state, self._heard = self._state, state, now
        if before is not None and state.stage == "ended" and (before.id, before.stage) != (state.id, "ended"):
            self._ended = now
        if self._wish is not None:
            self._wish.requester.on_state(state, now)

    def cancel(self, now: float, page: int = 0, n: int = 0) -> None:
        """End the route of this service's pages; `page`: only that of this page, and `n`: only of this number."""
        wish = self._wish
        if wish is not None and page in (0, wish.page) and n in (0, wish.n):
            wish.motion.cancel(now)

    def stop(self, device: str, now: float) -> None:
        """End whichever route goes on: somebody has pressed Stop."""
        self._log(f"{device} ends the route")
        if self._wish is not None:
            self._wish.motion.cancel(now)
        elif self._state is not None and self._goes_on(self._state, now):
            request = MotionCancel(by=f"{self._by} ({device})", id=self._state.id)
            self._cancelling = self._ask(PLACES_CANCEL, request)

    def poll(self, now: float, *, is_own_lease: bool) -> None:
        """Ask, hold and end. `is_own_lease`: this service still has the lease, and routes take it from nobody."""
        if self._cancelling is not None:
            is_over = self._state is None or not self._goes_on(self._state, now)
            self._cancelling = None if self._cancelling.poll(now) is not None or is_over else self._cancelling
        if (wish := self._wish) is None:
            return
        waits = not (wish.motion.has_asked or wish.motion.is_cancelled)
        if waits and now - wish.at > BEGINS_WITHIN:
            self._end(wish, _LATE)
        elif not (waits and is_own_lease) and (result := wish.motion.turn(now)) is not None:
            why = _UNHEARD if result.outcome == "lost_robot" else Trouble(result.reason)
            is_told = self._state is not None and (self._state.id, self._state.stage) == (wish.id, "ended")
            self._end(wish, None if is_told else why)

    def view(self, now: float) -> Route:
        """Return what all pages are shown."""
        wish, state = self._wish, self._state
        if wish is not None and (state is None or state.id != wish.id):
            return Route(stage="asking", page=wish.page, n=wish.n, by=wish.device, goal=wish.goal)
        is_shown = state is not None and (self._goes_on(state, now) or now - self._ended < TOLD_FOR)
        if state is None or state.goal is None or not is_shown:
            return Route()
        page, n, id_ = self._newest
        left = state.corners[-(state.steps - max(1, state.step) + 1) :]
        end = round(state.goal.x, 2), round(state.goal.y, 2)
        return Route(
            stage=state.stage,
            page=page if id_ == state.id else 0,
            n=n if id_ == state.id else 0,
            by=state.by,
            goal=state.place or end,
            end=end,
            corners=() if state.stage == "ended" else tuple((round(x, 2), round(y, 2)) for x, y in left),
            at=state.at and (round(state.at[0], 2), round(state.at[1], 2)),
            leg=state.step,
            legs=state.steps,
            come=round(state.achieved.path, 1),
            way=round(state.asked.path, 1),
            outcome=state.outcome,
            why=state.reason,
        )

    def _ask(self, query: Query[Any, Any], request: Any) -> RetriedRequest[Any]:
        return self._io.ask(query, request, lambda _: True)

    def _goes_on(self, state: RouteState, now: float) -> bool:
        return state.stage not in ("idle", "ended") and is_fresh(ROUTE, now - self._heard)

    def _end(self, wish: _Wish, why: Trouble | None) -> None:
        """`why`: what only its page is told; None: all pages see it."""
        self._wish = None
        if why is not None:
            self._tell(wish.page, Refused(why=why, route=True))
            self._log(str(why.of(wish.device)))


def _tick(given: Moment) -> Tick | None:
    """Return what a page gives back; None: it is no tick."""
    time = time_of(given)
    return Tick(epoch=time.epoch, robot_ns=time.robot_ns) if time is not None and time.epoch else None
