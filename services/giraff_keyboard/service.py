"""The keyboard: keys pressed in a terminal to `cmd_vel/<operator>`."""

from __future__ import annotations

from typing import Any, Final, Protocol

from giraff_core.estop import is_confirmed_stop
from giraff_core.inbox import Inbox
from giraff_core.io import IO, Selectable
from giraff_core.robot import RobotConfig
from giraff_core.timer import Timer
from giraff_keyboard.config import KeyboardConfig
from giraff_keyboard.estop_request import EStopRequest
from giraff_keyboard.keys import KeyReader
from giraff_keyboard.policy import Key, KeyboardPolicy
from giraff_keyboard.status import StatusView
from giraff_schemas.messages import EStopEngage
from giraff_schemas.topics import BASE, BATTERY, ESTOP, ESTOP_ENGAGE, GUARD, LEASE, OPERATOR_CMD_VEL, TICK

_STATUS_HZ: Final = 10


class Screen(Selectable, Protocol):
    """Where a person types and reads: as `giraff_keyboard.terminal.Terminal`."""

    @property
    def is_gone(self) -> bool: ...
    def read(self) -> bytes: ...
    def show(self, lines: list[str]) -> None: ...


class Keyboard:
    """Reads the terminal, `tick` and `lease`; writes `cmd_vel/<operator>` and asks `estop/engage`.

    Shows `base`, `guard`, `estop` and `battery` to the person who drives.
    """

    def __init__(self, io: IO, config: KeyboardConfig, robot: RobotConfig, screen: Screen) -> None:
        self._io = io
        self.link = screen
        self._screen = screen
        self._policy = KeyboardPolicy(config, robot, io.instance)
        self._keys, self._heard = KeyReader(), StatusView()
        engage = EStopEngage(by=f"{config.operator}@{io.hostname}", reason="space bar")
        self.stopping = EStopRequest(lambda: io.ask(ESTOP_ENGAGE, engage, is_confirmed_stop))
        self._ticks, self._leases = io.inbox(TICK, limit=1), io.inbox(LEASE, limit=10)
        self._told: list[Inbox[Any]] = [io.inbox(topic, limit=10) for topic in (BASE, GUARD, ESTOP, BATTERY)]
        self._commands = io.publisher(OPERATOR_CMD_VEL.at(config.operator))
        self._timer, self._status_timer = Timer(OPERATOR_CMD_VEL.rate_hz), Timer(_STATUS_HZ)
        self.timers = (self._timer,)

    def turn(self, now: float) -> None:
        policy = self._policy
        # Before the ticks: a press is of the newest one before it.
        pressed = self._keys.feed(self._screen.read(), now)
        if self._screen.is_gone:
            self._io.leave()
            return
        for key in pressed:
            policy.on_key(key, now)
            if key is Key.STOP:
                self.stopping.engage()
        for tick in self._ticks.take():
            policy.on_tick(tick, now)
        for lease in self._leases.take():
            policy.on_lease(lease)
        for sample in (sample for inbox in self._told for sample in inbox.take()):
            self._heard.take(sample, now)
            self.stopping.on_sample(sample)
        if self.stopping.poll(now):
            policy.on_stopped()
        if self._timer.due(now) or pressed:
            command = policy.command(now)
            self._commands.put(command)
            self._io.set_notice("keys", command.reason)
            self._io.set_notice("lease", policy.refusal)
        if self._status_timer.due(now) or pressed:
            self._screen.show(self._heard.lines(policy, self.stopping.text, now))

    def end(self) -> None:
        """Let go of the robot."""
        self._commands.put(self._policy.final_command())
