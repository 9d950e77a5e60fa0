"""`giraff top`: what a robot's services take and how its topics flow, as long as anybody looks."""

import math
import time
from collections.abc import Sequence
from contextlib import closing
from typing import Final

from giraff_cli.top.report import Loads, TopView, report_of
from giraff_tools.network.command import run_with_robot
from giraff_tools.network.connection import RobotConnection
from giraff_tools.network.robot_graph import GraphMonitor
from giraff_tools.terminal.page import print_json, print_trimmed
from giraff_tools.terminal.screen import LineScreen, Terminal, open_screen
from giraff_tools.terminal.signals import StopSignal

_TURN: Final = 0.05  # s
_SHOW_EVERY: Final = 0.5  # s
_ONCE: Final = 2.5  # s in which every rate and every load shows


def top(robot: str | None, connect: Sequence[str], seconds: float | None, *, once: bool, as_json: bool) -> int:
    """Until Ctrl-C, for `seconds` or once; the exit code."""
    with StopSignal() as stopping:
        longest = math.inf if seconds is None else seconds
        return run_with_robot(robot, connect, lambda met: Top(met, stopping, as_json=as_json).run(longest, once))


class Top:
    """Looks and shows."""

    def __init__(self, connection: RobotConnection, stopping: StopSignal, *, as_json: bool) -> None:
        self._stopping = stopping
        self._as_json = as_json
        self._monitor = GraphMonitor.counting(connection)
        self._loads = Loads()
        self._began = time.monotonic()

    def run(self, seconds: float, once: bool) -> int:
        """The whole of it; the exit code. Raises NoRobotError."""
        self._monitor.wait_for_robot(self._stopping)
        self._began = time.monotonic()
        if once:
            return self._once()
        with closing(LineScreen() if self._as_json else open_screen()) as screen:
            every = _SHOW_EVERY if isinstance(screen, Terminal) else _SHOW_EVERY / 5.0  # lines pace themselves
            while True:
                view = self._view()
                screen.show(view)
                if self._listen(min(every, seconds - view.elapsed)):
                    return 0

    def _once(self) -> int:
        self._listen(_ONCE)
        if self._as_json:
            print_json(self._view().report)
        else:
            print_trimmed(self._view().render())
        return 0

    def _listen(self, seconds: float) -> bool:
        """For so long; whether this was the last time."""
        if seconds <= 0.0:
            return True
        until = time.monotonic() + seconds
        while (now := time.monotonic()) < until:
            self._monitor.update(now, again=True)
            self._loads.update(self._monitor.robot_graph)
            if self._stopping.wait(min(_TURN, max(0.0, until - now))):
                return True
        return False

    def _view(self) -> TopView:
        now = time.monotonic()
        report = report_of(self._monitor.robot_graph, self._loads, now - self._began, now)
        return TopView(report, self._as_json)
