"""`giraff top`: what a robot's services take and how its topics flow, as long as anybody looks."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from contextlib import closing
from typing import Final

from giraff_cli.network.command import visit
from giraff_cli.network.connection import Watcher
from giraff_cli.network.header_subscriber import Meter
from giraff_cli.network.robot_graph import Surveyor
from giraff_cli.terminal.page import print_json, print_trimmed
from giraff_cli.terminal.screen import Lines, Terminal, open_screen
from giraff_cli.terminal.signals import Stopping
from giraff_cli.top.report import Loads, TopSight, report_of

_PATIENCE: Final = 3.0  # s, to find the only robot
_TURN: Final = 0.05  # s
_SHOW_EVERY: Final = 0.5  # s
_ONCE: Final = 2.5  # s in which every rate and every load shows


def top(robot: str | None, connect: Sequence[str], seconds: float | None, *, once: bool, as_json: bool) -> int:
    """Until Ctrl-C, for `seconds` or once; the exit code."""
    with Stopping() as stopping:
        return visit(
            robot,
            connect,
            _PATIENCE,
            lambda watcher: Top(watcher, stopping, as_json=as_json).go(math.inf if seconds is None else seconds, once),
        )


class Top:
    """Looks and shows."""

    def __init__(self, watcher: Watcher, stopping: Stopping, *, as_json: bool) -> None:
        self._stopping = stopping
        self._as_json = as_json
        self._surveyor = Surveyor(watcher, [Meter(watcher.session, watcher.robot)])
        self._loads = Loads()
        self._began = time.monotonic()

    def go(self, seconds: float, once: bool) -> int:
        """The whole of it; the exit code. Raises NoRobotError."""
        self._surveyor.meet(self._stopping)
        self._began = time.monotonic()
        if once:
            return self._once()
        with closing(Lines() if self._as_json else open_screen()) as screen:
            every = _SHOW_EVERY if isinstance(screen, Terminal) else _SHOW_EVERY / 5.0  # lines pace themselves
            while True:
                sight = self._sight()
                screen.show(sight)
                if self._listen(min(every, seconds - sight.elapsed)):
                    return 0

    def _once(self) -> int:
        self._listen(_ONCE)
        if self._as_json:
            print_json(self._sight().report)
        else:
            print_trimmed(self._sight().picture())
        return 0

    def _listen(self, seconds: float) -> bool:
        """For so long; whether this was the last time."""
        if seconds <= 0.0:
            return True
        until = time.monotonic() + seconds
        while (now := time.monotonic()) < until:
            self._surveyor.look(now, again=True)
            self._loads.take(self._surveyor.survey)
            if self._stopping.wait(min(_TURN, max(0.0, until - now))):
                return True
        return False

    def _sight(self) -> TopSight:
        now = time.monotonic()
        report = report_of(self._surveyor.survey, self._loads, now - self._began, now)
        return TopSight(report, self._as_json)
