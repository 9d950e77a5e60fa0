"""The pages: what their hands ask to `cmd_vel/<operator>`, and what the robot says to all of them."""

from collections.abc import Callable, Iterable
from typing import Any, Final

import msgspec

from giraff_core.estop.request import Request
from giraff_core.io import IO, Inbox
from giraff_core.operator import Fault, OperatorService, Wish
from giraff_core.picture.receiver import OpenSource
from giraff_core.robot import RobotConfig
from giraff_core.senses import SENSED
from giraff_core.timer import Timer
from giraff_schemas.camera import CameraState
from giraff_schemas.localization import MapWalls
from giraff_schemas.messages import EStop, Sample
from giraff_schemas.places import Places, RouteState
from giraff_schemas.requests import EStopAnswer, EStopEngage, EStopReset
from giraff_schemas.topics import (
    ATTITUDE,
    BASE,
    BATTERY,
    CAMERA_STATE,
    ESTOP,
    ESTOP_ENGAGE,
    ESTOP_RESET,
    GUARD,
    MAP,
    ODOM,
    PLACES,
    POSE,
    ROUTE,
    Topic,
)
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_web.camera import PageCameras
from giraff_web.config import WebConfig
from giraff_web.hand import time_of
from giraff_web.messages import (
    Go,
    Hello,
    LetGo,
    Lines,
    Look,
    PageWish,
    PictureSeen,
    Plan,
    Refused,
    Reset,
    Room,
    Route,
    RouteCancel,
    RouteHold,
)
from giraff_web.pages import Closed, Event, Opened, Pages, Said, StopAsked
from giraff_web.picture import Picture
from giraff_web.policy import NOBODY, WebPolicy
from giraff_web.route import PageRoutes
from giraff_web.stops import Stops

SHOWN_HZ: Final = 25
"""States a second; each tick that goes down to a page is at most 0.04 s older for it."""
_LAST: Final = 10
"""Samples of a topic between two turns of which none is left out."""


class Web(OperatorService):
    """Serves all pages with one stream of the robot. Reads and writes as the table of services says."""

    def __init__(
        self,
        io: IO,
        config: WebConfig,
        robot: RobotConfig,
        pages: Pages,
        log: Callable[[str], None],
        room: Room | None = None,
        open_source: OpenSource | None = None,
    ) -> None:
        """`log`: takes a line for people: who drove, stopped, reset, looked. `room`: that is shown around the robot.

        `open_source`: looks at the robot's camera; None: no page does.
        """
        self._io, self._config, self._robot, self._pages = io, config, robot, pages
        self._log, self._room = log, room
        self._policy = WebPolicy(config, robot, io.instance)
        self._picture = Picture(robot, is_open=io.is_open)
        self._by = f"{config.operator}@{io.hostname}"
        self._stops = Stops(self._engage, self._reset, self._log, is_open=io.is_open)
        self._looking = PageCameras(pages, self._by, open_source)
        self._routes = PageRoutes(io, self._by, pages.send, log)
        super().__init__(io, self._policy)
        self.link = pages
        told: tuple[Topic[Any], ...] = (BASE, GUARD, ESTOP, BATTERY, *SENSED.values(), CAMERA_STATE, ROUTE)
        self._told: list[Inbox[Any]] = [io.inbox(topic, limit=_LAST, wakes=topic is ESTOP) for topic in told]
        newest: list[Topic[Any]] = [ODOM, ATTITUDE, POSE, MAP, PLACES]
        self._told += [io.inbox(topic, limit=1, wakes=False) for topic in newest]
        self._show_timer = Timer(SHOWN_HZ)
        self.timers = (self.timer, self._show_timer)
        self._lost: dict[int, Trouble] = {}
        self._driver = NOBODY
        self._lookers = ""
        self._open: set[int] = set()
        """Pages that are open."""
        self._walls: MapWalls | None = None
        self._places: Places | None = None
        self._plan: Plan | None = None
        """Floor plan that the pages were told last."""
        self._route = Route()
        """Route that the pages were told last."""

    def turn(self, now: float) -> None:
        policy = self._policy
        # Before the ticks: a wish is of one that its page held already.
        for event in self._pages.poll():
            self._on_event(event, now)
        self.read_inboxes(now)
        for sample in (sample for inbox in self._told for sample in inbox.pop_all()):
            self._on_sample(sample, now)
        self._stops.poll(now)
        if (word := self._stops.confirmed(now)) is not None:
            self._pages.confirm(word)
        policy.stopping = self._stops.asked
        self.say(now)
        self._routes.poll(now, is_own_lease=policy.operator.holder == policy.operator.name)
        if self._show_timer.due(now):
            if (route := self._routes.view(now)) != self._route:
                self._route = route
                self._tell_all(route)
            self._pages.show(self._picture.state(policy, self._stops.outcome, now, self._looking.view(now)))
        self._looking.poll(now)
        if (devices := self._looking.devices) != self._lookers:
            self._lookers = devices
            self._log(f"the camera's picture is on at {devices or 'no page'}")

    def end(self) -> None:
        super().end()
        self._looking.close()

    def on_said(self, asked: Wish | Fault, now: float) -> None:
        super().on_said(asked, now)
        self._tell_pages()

    def _on_sample(self, sample: Sample, now: float) -> None:
        match sample:
            case CameraState():
                self._looking.on_state(sample, now)
            case MapWalls() | Places():
                self._on_plan(sample)
            case RouteState():
                self._routes.on_state(sample, now)
            case _:
                self._picture.on_sample(sample, now)
                if isinstance(sample, EStop):
                    self._stops.on_estop(sample, now)

    def _on_event(self, event: Event, now: float) -> None:
        policy = self._policy
        match event:
            case Opened():
                policy.on_opened(event.page, event.device, may_drive=event.may_drive)
                self._pages.send(event.page, self._hello(event))
                self._open.add(event.page)
                if self._plan is not None:
                    self._pages.send(event.page, self._plan)
                if self._route != Route():
                    self._pages.send(event.page, self._route)
            case Closed():
                policy.on_closed(event.page)
                self._routes.cancel(now, event.page)
                self._open.discard(event.page)
                self._looking.on_closed(event.page)
                self._lost.pop(event.page, None)
            case StopAsked():
                policy.on_stop(event.device)
                self._routes.cancel(now)
                self._stops.stop(event.device, now, off=event.off)
            case Said(page, PictureSeen(n=n)):
                self._looking.on_seen(page, n, now)
            case Said():
                self._take_said(event, now)
                self.timer.fire_now("page", now)

    def _on_plan(self, sample: MapWalls | Places) -> None:
        """Tell all pages a plan that is another than before: walls and places are said again and again."""
        if isinstance(sample, Places):
            self._places = sample
        else:
            self._walls = sample
        if self._walls is not None and (plan := _plan(self._walls, self._places)) != self._plan:
            self._plan = plan
            self._tell_all(plan)

    def _tell_all(self, message: Plan | Route) -> None:
        for page in self._open:
            self._pages.send(page, message)

    def _take_said(self, said: Said, now: float) -> None:
        page, policy = said.page, self._policy
        match said.message:
            case PageWish() as wish:
                policy.on_wish(page, wish, now)
                if wish.hold and policy.may_drive(page):  # a hand takes over
                    self._routes.cancel(now)
            case LetGo() as message:
                policy.on_let_go(page, message)
            case Reset() as reset:
                self._take_reset(page, reset, now)
            case Look(on=on) if policy.may_drive(page):  # who may not drive may not see
                self._looking.switch(page, policy.device(page), on=on)
            case Go() as go if policy.may_drive(page):
                self._routes.go(page, policy.device(page), go, policy.give_way(), now)
            case RouteHold() as hold:
                self._routes.on_hold(page, hold, now)
            case RouteCancel(n=0):
                self._routes.stop(policy.device(page), now)
            case RouteCancel(n=n):
                self._routes.cancel(now, page, n)

    def _take_reset(self, page: int, reset: Reset, now: float) -> None:
        if not self._policy.may_drive(page):
            return
        device = self._policy.device(page)
        asked = EStopReset(
            by=f"{self._by} ({device})",
            id=int(reset.id),
            tick=time_of(reset.tick),
            engaged_ns=int(reset.engaged_ns),
        )
        self._stops.reset(device, asked, now)

    def _engage(self, device: str, settles: Callable[[EStopAnswer], bool | str], off: bool) -> Request:
        reason = Trouble("STOP held on a page" if off else "STOP on a page")
        asked = EStopEngage(by=f"{self._by} ({device})", reason=reason, off=off)
        return self._io.ask(ESTOP_ENGAGE, asked, settles)

    def _reset(self, asked: EStopReset) -> Request:
        return self._io.ask(ESTOP_RESET, asked, lambda _: True)

    def _tell_pages(self) -> None:
        """Who drives, in the log; and each page whose hold has come to count no more."""
        driver, lost = self._policy.driver, self._policy.lost()
        if driver != self._driver:
            self._driver = driver
            self._log(f"{driver.device} drives" if driver.page else "nobody's page drives any more")
        for page, why in lost.items():
            if why != self._lost.get(page, NO_TROUBLE):
                self._pages.send(page, Refused(why=why))
                if why:
                    self._log(str(why.of(self._policy.device(page))))
        self._lost = lost

    def _hello(self, page: Opened) -> Hello:
        return Hello(
            page=page.page,
            device=page.device,
            may_drive=page.may_drive,
            robot=self._robot.name,
            radius=self._robot.footprint_radius,
            track=self._robot.kinematics.track_width,
            slow_speed=self._config.slow_speed,
            trail=self._picture.trail,
            room=self._room,
        )


def _plan(walls: MapWalls, known: Places | None) -> Plan:
    """Return the floor plan with its places. Those of another plan do not count."""
    plan = Plan(map=walls.map, walls=_lines(walls.walls))
    if known is None or not known.are_on(walls.map):
        return plan
    no_go = _lines((line.x, line.y, line.end_x, line.end_y) for line in known.no_go)
    return msgspec.structs.replace(plan, places=known.places, no_go=no_go)


def _lines(segments: Iterable[tuple[float, float, float, float]]) -> Lines:
    rounded = ([round(value, 3) for value in segment] for segment in segments)
    return tuple(((x, y), (end_x, end_y)) for x, y, end_x, end_y in rounded)
