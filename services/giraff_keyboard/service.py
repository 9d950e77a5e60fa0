"""The keyboard: keys pressed in a terminal to `cmd_vel/<operator>`."""

from collections.abc import Callable, Sequence
from typing import Any, Final, Protocol

from giraff_core.estop.request import EStopRequest, Request
from giraff_core.io import IO, Inbox, Selectable
from giraff_core.operator import OperatorService
from giraff_core.robot import RobotConfig
from giraff_core.timer import Timer
from giraff_keyboard.config import KeyboardConfig
from giraff_keyboard.keys import KeyReader, StopHold
from giraff_keyboard.policy import Key, KeyboardPolicy
from giraff_keyboard.reset_request import ResetRequest
from giraff_schemas.messages import EStop, RobotTime, Sample
from giraff_schemas.requests import EStopAnswer, EStopEngage, EStopReset
from giraff_schemas.topics import (
    ESTOP_ENGAGE,
    ESTOP_RESET,
    Topic,
)
from giraff_schemas.trouble import Trouble

_STATUS_HZ: Final = 10
_LAST: Final = 10
"""Samples of a topic between two turns of which none is left out."""


class Screen(Selectable, Protocol):
    """Where a person types and reads: as `giraff_keyboard.terminal.Terminal`."""

    @property
    def topics(self) -> Sequence[Topic[Any]]:
        """What it tells of; `estop` is among them."""
        ...

    @property
    def is_gone(self) -> bool: ...
    def read(self) -> bytes: ...
    def on_sample(self, sample: Sample, now: float) -> None: ...
    def show(self, policy: KeyboardPolicy, stop: Trouble, now: float) -> None: ...


class Keyboard(OperatorService):
    """Reads the terminal, `tick` and `lease`; writes `cmd_vel/<operator>`, asks `estop/engage` and `estop/reset`."""

    def __init__(self, io: IO, config: KeyboardConfig, robot: RobotConfig, screen: Screen) -> None:
        self._io, self._screen = io, screen
        self._policy = KeyboardPolicy(config, robot, io.instance)
        self._keys = KeyReader()
        by = f"{config.operator}@{io.hostname}"
        self._hold = StopHold()

        def engage(settles: Callable[[EStopAnswer], bool | str], off: bool) -> Request:
            asked = EStopEngage(by=by, reason=Trouble("space bar held" if off else "space bar"), off=off)
            return io.ask(ESTOP_ENGAGE, asked, settles)

        self.stopping = EStopRequest(engage, is_open=io.is_open)

        def reset(shown: EStop, moment: RobotTime) -> Request:
            asked = EStopReset(by=by, id=shown.id, tick=moment, engaged_ns=shown.engaged_ns)
            return io.ask(ESTOP_RESET, asked, lambda _: True)

        self._resetting = ResetRequest(reset)
        super().__init__(io, self._policy)
        self.link = screen
        self._told: list[Inbox[Any]] = [io.inbox(topic, limit=_LAST) for topic in screen.topics]
        self._status_timer = Timer(_STATUS_HZ)

    def turn(self, now: float) -> None:
        policy = self._policy
        # Before the ticks: a press is of the newest one before it.
        pressed = self._keys.feed(self._screen.read(), now)
        if self._screen.is_gone:
            self._io.leave()
            return
        for key in pressed:
            policy.on_key(key, now)
            self.timer.fire_now("key", now)
            if key is Key.STOP:
                self.stopping.engage(off=self._hold.on_stop(now))
            self._resetting.on_key(key, policy.moment(now), now, stopping=self.stopping.asked)
        self.read_inboxes(now)
        for sample in (sample for inbox in self._told for sample in inbox.pop_all()):
            self._screen.on_sample(sample, now)
            self.stopping.on_sample(sample)
            self._resetting.on_sample(sample, now)
        self._resetting.poll(now)
        if self.stopping.poll(now):
            policy.on_stopped()
        self.say(now)
        if self._status_timer.due(now) or pressed:
            self._screen.show(policy, self._stop_outcome, now)

    def ask_on(self, now: float) -> None:
        """Go on asking for a stop after the last turn."""
        for sample in (sample for inbox in self._told for sample in inbox.pop_all()):
            self.stopping.on_sample(sample)
        self.stopping.poll(now)

    @property
    def _stop_outcome(self) -> Trouble:
        """What became of the stop that was asked for, or of its release."""
        return self.stopping.outcome if self.stopping.asked else self._resetting.outcome or self.stopping.outcome
