"""`giraff watch`: a live robot on the operator's terminal, as long as anybody looks, whatever becomes of the robot."""

from __future__ import annotations

import gc
import math
import time
from collections.abc import Sequence
from contextlib import closing
from typing import Final

from giraff_cli.network.command import MovedError, complain, join
from giraff_cli.network.connection import Watcher
from giraff_cli.telemetry.collector import Snapshot, Telemetry
from giraff_cli.terminal.output import DONE
from giraff_cli.terminal.screen import Lines, Screen, Terminal, open_screen
from giraff_cli.terminal.signals import Stopping
from giraff_cli.watch.report import ReportSight
from giraff_cli.watch.screen import WatchSight
from giraff_node import robot_now_ns
from giraff_node.network.discovery import Roster, only_one, unheard
from giraff_node.network.host_addresses import AddressWatch, host_addresses
from giraff_node.network.tcp_options import tune_links
from giraff_schemas.topics import CMD_VEL, OPERATOR_CMD_VEL, SERIAL, SERIAL_WRITE, TICK, TILT, TOPICS, WHEELS

_LOOK_EVERY: Final = 0.5  # s; a picture costs 7 ms of a core
_LINE_EVERY: Final = 1.0  # s
_MEET_WITHIN: Final = 1.0  # s until a robot that is there has told everything; the slowest is told every 0.5 s
_MEET_EVERY: Final = 0.05  # s
_NOTICED_FOR: Final = 3_000_000_000  # ns

_NOT_NEEDED: Final = (TICK, TILT, OPERATOR_CMD_VEL, CMD_VEL, WHEELS, SERIAL, SERIAL_WRITE)
"""Two thirds of all samples, and each costs a tenth of a millisecond."""


def watch(robot: str | None, connect: Sequence[str], seconds: float | None, *, as_json: bool) -> int:
    """Until Ctrl-C, or for `seconds`; the exit code."""
    with Stopping() as stopping:
        return join(robot, connect, lambda watcher: Watch(watcher, stopping, seconds, as_json=as_json).go())


class Watch:
    """Looks at what is heard, and shows it."""

    def __init__(self, watcher: Watcher, stopping: Stopping, seconds: float | None, *, as_json: bool) -> None:
        """`watcher`: its robot may yet be unnamed."""
        self._watcher = watcher
        self._stopping = stopping
        self._seconds = math.inf if seconds is None else seconds
        self._as_json = as_json
        self._telemetry = Telemetry()
        self._roster = Roster(watcher.session)
        self._began = time.monotonic()
        self._addresses = AddressWatch(host_addresses())
        self._listens = False
        self._follows_wheels = False

    def go(self) -> int:
        """The whole of it; the exit code. Raises NoRobotError where several are there and none is named; MovedError."""
        gc.freeze()  # what is imported stays: a tenth of what a picture costs is looking through it
        self._meet()
        with closing(Lines() if self._as_json else open_screen()) as screen:
            sight = self._show_on(screen)
        if sight.waiting and not self._stopping.asked:
            return complain(f"{sight.waiting} (waited {self._seconds:g} s)")
        return DONE

    def _meet(self) -> None:
        """Hear all of a robot that is there before anything of it is shown."""
        until = min(self._seconds, _MEET_WITHIN)
        while self._elapsed < until and not self._stopping.wait(_MEET_EVERY):
            snapshot = self._look().snapshot
            if None not in (snapshot.odometry, snapshot.lease, snapshot.guard, snapshot.base, snapshot.estop):
                return

    def _show_on(self, screen: Screen) -> WatchSight:
        """Until the end; the last that was seen."""
        every = _LOOK_EVERY if isinstance(screen, Terminal) else _LINE_EVERY
        while True:
            sight = self._look()
            screen.show(sight)
            left, next_look = self._seconds - self._elapsed, every - self._elapsed % every
            if left <= 0.0 or self._stopping.wait(min(left, next_look)):
                return sight

    @property
    def _elapsed(self) -> float:
        """s since it began."""
        return time.monotonic() - self._began

    def _look(self) -> WatchSight:
        """Take in what there is. Raises MovedError."""
        now = time.monotonic()
        if math.isinf(self._seconds) and self._addresses.due(now) and self._addresses.moved(now, host_addresses()):
            raise MovedError
        tune_links()
        there = self._roster.names
        self._find()
        self._watcher.pass_on(self._telemetry)
        now_ns = robot_now_ns()
        snapshot = self._telemetry.snapshot(now_ns)
        if self._listens:
            self._mind_wheels(snapshot)
        is_there = snapshot.silence is not None or bool(snapshot.services)
        kind = ReportSight if self._as_json else WatchSight
        return kind(
            robot=self._watcher.robot,
            elapsed=self._elapsed,
            snapshot=snapshot,
            waiting="" if is_there else unheard(self._watcher.robot, there),
            notices=tuple(self._watcher.complaints_since(now_ns - _NOTICED_FOR)),
        )

    def _find(self) -> None:
        """Settle whom to watch, and listen to it from then on."""
        if self._listens:
            return
        if not self._watcher.robot and (found := self._roster.settled):
            self._watcher.robot = only_one(found)
        if self._watcher.robot:
            self._watcher.listen(topic for topic in TOPICS if topic not in _NOT_NEEDED)
            self._listens = True

    def _mind_wheels(self, snapshot: Snapshot) -> None:
        """Listen to the wheels while odometry is silent."""
        needed = snapshot.odometry is None or not snapshot.odometry.fresh
        if needed and not self._follows_wheels:
            self._watcher.follow(WHEELS)
        elif self._follows_wheels and not needed:
            self._watcher.leave(WHEELS)
        self._follows_wheels = needed
        if not needed:
            self._telemetry.forget(WHEELS)
