"""The pages: what their hands ask to `cmd_vel/<operator>`, and what the robot says to all of them."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, Final

from giraff_core.estop_request import Request
from giraff_core.inbox import Inbox
from giraff_core.io import IO
from giraff_core.robot import RobotConfig
from giraff_core.timer import PromptTimer, Timer
from giraff_schemas.messages import EStop
from giraff_schemas.requests import EStopAnswer, EStopEngage, EStopReset
from giraff_schemas.topics import (
    BASE,
    BATTERY,
    ESTOP,
    ESTOP_ENGAGE,
    ESTOP_RESET,
    GUARD,
    LEASE,
    ODOM,
    OPERATOR_CMD_VEL,
    RANGE,
    TICK,
)
from giraff_web.config import WebConfig
from giraff_web.hand import time_of
from giraff_web.limited_log import LimitedLog
from giraff_web.messages import Hello, LetGo, Refused, Reset, Room, Wish
from giraff_web.pages import Closed, Event, Opened, Pages, Said, StopAsked
from giraff_web.picture import Picture
from giraff_web.policy import NOBODY, WebPolicy
from giraff_web.stops import Stops

SHOWN_HZ: Final = 25
"""States a second; each tick that goes down to a page is at most 0.04 s older for it."""
_LAST: Final = 10
"""Samples of a topic between two turns of which none is left out."""


class Web:
    """Serves all pages with one stream of the robot. Reads and writes as the table of services says."""

    def __init__(
        self,
        io: IO,
        config: WebConfig,
        robot: RobotConfig,
        pages: Pages,
        log: Callable[[str], None],
        room: Room | None = None,
    ) -> None:
        """`log`: takes a line for people: who drove, stopped, reset. `room`: that is shown around the robot."""
        self._io, self._config, self._robot = io, config, robot
        self.link = self._pages = pages
        self._log, self._room = LimitedLog(log), room
        self._policy = WebPolicy(config, robot, io.instance)
        self._picture = Picture(robot)
        self._by = f"{config.operator}@{io.hostname}"
        self._stops = Stops(self._engage, self._reset, self._log)
        self._ticks, self._leases = io.inbox(TICK, limit=1), io.inbox(LEASE, limit=_LAST)
        told = (BASE, GUARD, ESTOP, BATTERY, RANGE)
        self._told: list[Inbox[Any]] = [io.inbox(topic, limit=_LAST, wakes=topic is ESTOP) for topic in told]
        self._told.append(io.inbox(ODOM, limit=1, wakes=False))
        self._commands = io.publisher(OPERATOR_CMD_VEL.at(config.operator))
        self._timer, self._show_timer = PromptTimer(OPERATOR_CMD_VEL.rate_hz), Timer(SHOWN_HZ)
        self.timers: tuple[Timer, ...] = (self._timer, self._show_timer)
        self._tick_heard = -math.inf
        self._lost: dict[int, str] = {}
        self._driver = NOBODY

    def turn(self, now: float) -> None:
        policy = self._policy
        # Before the ticks: a wish is of one that its page held already.
        for event in self._pages.poll():
            self._take(event, now)
        for tick in self._ticks.take():
            policy.on_tick(tick, now)
            self._tick_heard = now
        for lease in self._leases.take():
            policy.on_lease(lease)
        for sample in (sample for inbox in self._told for sample in inbox.take()):
            self._picture.take(sample, now)
            if isinstance(sample, EStop):
                self._stops.on_estop(sample, now)
        self._stops.poll(now)
        if (word := self._stops.confirmed(now)) is not None:
            self._pages.confirm(word)
        policy.stopping = self._stops.asked
        if self._timer.due(now):
            command = policy.command(now)
            self._commands.put(command)
            self._tell_pages(now)
            self._io.set_notice("page", command.reason)
            self._io.set_notice("lease", policy.refusal if policy.driver.page else "")
            self._io.set_notice("rank", policy.rank_notice)
        if self._show_timer.due(now):
            self._pages.show(self._picture.state(policy, self._stops.text, now - self._tick_heard, now))

    def end(self) -> None:
        """Let go of the robot."""
        self._commands.put(self._policy.final_command())

    def _take(self, event: Event, now: float) -> None:
        policy = self._policy
        match event:
            case Opened():
                policy.on_opened(event.page, event.device, may_drive=event.may_drive)
                self._pages.tell(event.page, self._hello(event))
            case Closed():
                policy.on_closed(event.page)
                self._lost.pop(event.page, None)
            case StopAsked():
                policy.on_stop(event.device)
                self._stops.stop(event.device, now)
            case Said(page, Wish() as wish):
                policy.on_wish(page, wish, now)
            case Said(page, LetGo() as message):
                policy.on_let_go(page, message)
            case Said(page, Reset() as reset):
                self._take_reset(page, reset, now)
        if isinstance(event, Said):
            self._timer.hurry("page", now)

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

    def _engage(self, device: str, settles: Callable[[EStopAnswer], bool | str]) -> Request:
        asked = EStopEngage(by=f"{self._by} ({device})", reason="STOP on a page")
        return self._io.ask(ESTOP_ENGAGE, asked, settles)

    def _reset(self, asked: EStopReset) -> Request:
        return self._io.ask(ESTOP_RESET, asked, lambda _: True)

    def _tell_pages(self, now: float) -> None:
        """Who drives, in the log; and each page whose hold has come to count no more."""
        driver, lost = self._policy.driver, self._policy.lost()
        if driver != self._driver:
            self._driver = driver
            self._log.say("driver", f"{driver.device} drives" if driver.page else "nobody's page drives any more", now)
        for page, why in lost.items():
            if why != self._lost.get(page, ""):
                self._pages.tell(page, Refused(why=why))
                if why:
                    self._log.say("lost", f"{self._policy.device(page)}: {why}", now)
        self._lost = lost

    def _hello(self, page: Opened) -> Hello:
        return Hello(
            page=page.page,
            device=page.device,
            may_drive=page.may_drive,
            robot=self._robot.name,
            radius=self._robot.footprint_radius,
            sensors=self._picture.sensors,
            slow_speed=self._config.slow_speed,
            trail=self._picture.trail,
            room=self._room,
        )
