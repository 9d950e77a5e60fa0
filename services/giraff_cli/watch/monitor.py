"""`giraff watch`: a live robot on the operator's terminal, as long as anybody looks, whatever becomes of the robot."""

import gc
import math
import time
from collections.abc import Sequence
from contextlib import closing
from typing import Final

from giraff_cli.watch.screen import ReportView, WatchView
from giraff_node import robot_now_ns
from giraff_node.network.discovery import RobotMonitor, not_found_text, select_robot
from giraff_node.network.host_addresses import AddressWatch, host_addresses
from giraff_node.network.tcp_options import set_tcp_options
from giraff_schemas.topics import (
    CAMERA_ON,
    CMD_VEL,
    MAP,
    OPERATOR_CMD_VEL,
    PARTICLES,
    SERIAL,
    SERIAL_WRITE,
    TICK,
    TILT,
    TOPICS,
    WHEELS,
)
from giraff_telemetry.collector import Snapshot, Telemetry
from giraff_tools.network.command import print_error, run_on_network
from giraff_tools.network.connection import MovedError, RobotConnection
from giraff_tools.terminal.output import DONE
from giraff_tools.terminal.screen import LineScreen, Screen, Terminal, open_screen
from giraff_tools.terminal.signals import StopSignal

_LOOK_EVERY: Final = 0.5  # s; a picture costs 7 ms of a core
_LINE_EVERY: Final = 1.0  # s
_MEET_WITHIN: Final = 1.0  # s until a robot that is there has told everything; the slowest is told every 0.5 s
_MEET_EVERY: Final = 0.05  # s
_NOTICED_FOR: Final = 3_000_000_000  # ns

_NOT_NEEDED: Final = (TICK, TILT, OPERATOR_CMD_VEL, CMD_VEL, WHEELS, SERIAL, SERIAL_WRITE, PARTICLES, MAP, CAMERA_ON)
"""Two thirds of all samples, and each costs a tenth of a millisecond."""


def watch(robot: str | None, connect: Sequence[str], seconds: float | None, *, as_json: bool) -> int:
    """Until Ctrl-C, or for `seconds`; the exit code."""
    with StopSignal() as stopping:
        return run_on_network(
            robot, connect, lambda met: Watch(met, stopping, seconds, as_json=as_json).run(), stands_in=True
        )


class Watch:
    """Looks at what is heard, and shows it."""

    def __init__(
        self, connection: RobotConnection, stopping: StopSignal, seconds: float | None, *, as_json: bool
    ) -> None:
        """`connection`: its robot may yet be unnamed."""
        self._connection = connection
        self._stopping = stopping
        self._seconds = math.inf if seconds is None else seconds
        self._as_json = as_json
        self._telemetry = Telemetry()
        self._monitor = RobotMonitor(connection.session)
        self._began = time.monotonic()
        self._addresses = AddressWatch(host_addresses())
        self._listens = False
        self._is_shown = False
        self._follows_wheels = False

    def run(self) -> int:
        """The whole of it; the exit code. Raises NoRobotError where several are there and none is named; MovedError."""
        gc.freeze()  # what is imported stays: a tenth of what a picture costs is looking through it
        self._meet()
        with closing(LineScreen() if self._as_json else open_screen()) as screen:
            view = self._show_on(screen)
        if view.waiting and not self._stopping.asked:
            return print_error(f"{view.waiting} (waited {self._seconds:g} s)")
        return DONE

    def _meet(self) -> None:
        """Hear all of a robot that is there before anything of it is shown."""
        until = min(self._seconds, _MEET_WITHIN)
        while self._elapsed < until and not self._stopping.wait(_MEET_EVERY):
            snapshot = self._update().snapshot
            if None not in (snapshot.odometry, snapshot.lease, snapshot.guard, snapshot.base, snapshot.estop):
                return

    def _show_on(self, screen: Screen) -> WatchView:
        """Until the end; the last that was seen."""
        self._is_shown = True
        every = _LOOK_EVERY if isinstance(screen, Terminal) else _LINE_EVERY
        while True:
            view = self._update()
            screen.show(view)
            left, next_look = self._seconds - self._elapsed, every - self._elapsed % every
            if left <= 0.0 or self._stopping.wait(min(left, next_look)):
                return view

    @property
    def _elapsed(self) -> float:
        """s since it began."""
        return time.monotonic() - self._began

    def _update(self) -> WatchView:
        """Take in what there is. Raises MovedError."""
        now = time.monotonic()
        if math.isinf(self._seconds) and self._addresses.due(now) and self._addresses.moved(now, host_addresses()):
            raise MovedError
        set_tcp_options()
        there = self._monitor.names
        self._find()
        self._connection.dispatch(self._telemetry)
        now_ns = robot_now_ns()
        snapshot = self._telemetry.snapshot(now_ns)
        if self._listens:
            self._mind_wheels(snapshot)
        is_there = snapshot.silence is not None or bool(snapshot.services)
        kind = ReportView if self._as_json else WatchView
        return kind(
            robot=self._connection.robot,
            elapsed=self._elapsed,
            snapshot=snapshot,
            waiting="" if is_there else not_found_text(self._connection.robot, there),
            notices=tuple(self._connection.complaints_since(now_ns - _NOTICED_FOR)),
        )

    def _find(self) -> None:
        """Settle whom to watch, and listen to it from then on."""
        if self._listens:
            return
        if not self._connection.robot and (found := self._monitor.settled):
            self._connection.robot = select_robot(
                self._connection.session, found, self._connection.filed, asks=not self._is_shown
            )
        if self._connection.robot:
            self._connection.subscribe_all(topic for topic in TOPICS if topic not in _NOT_NEEDED)
            self._listens = True

    def _mind_wheels(self, snapshot: Snapshot) -> None:
        """Listen to the wheels while odometry is silent."""
        needed = snapshot.odometry is None or not snapshot.odometry.fresh
        if needed and not self._follows_wheels:
            self._connection.subscribe(WHEELS)
        elif self._follows_wheels and not needed:
            self._connection.unsubscribe(WHEELS)
        self._follows_wheels = needed
        if not needed:
            self._telemetry.forget(WHEELS)
