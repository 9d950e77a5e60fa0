"""`giraff estop`: stop a robot from any machine, and release it again.

Each answers with an exit code and a word for people. Nothing is taken for done before base has said so.
"""

from __future__ import annotations

import time
from typing import Any, Final, NamedTuple

from giraff_cli.network.connection import Watcher
from giraff_core.estop import RESET_COMMAND
from giraff_node.network.discovery import HOW_TO_REACH, others
from giraff_node.network.query_client import Asking, ask_to_stop
from giraff_schemas.messages import EStop, EStopReset, RobotTime, Sample, Tick
from giraff_schemas.topics import ESTOP, ESTOP_RESET, TICK, AnswerT, RequestT, Topic, key_of

RELEASED: Final = 0
ENGAGED: Final = 1
UNKNOWN: Final = 2

_TURN: Final = 0.01  # s
_TWO_PERIODS: Final = 2.5 / ESTOP.rate_hz  # s in which every base has told its state


class Told(NamedTuple):
    """How it ended."""

    code: int
    text: str


def engage(watcher: Watcher, by: str, reason: str, timeout: float) -> Told:
    """Ask again and again until base confirms that it has stopped and will stay so. 0: it has."""
    robot, deadline = watcher.robot, time.monotonic() + timeout
    asking = ask_to_stop(watcher.session, robot, by=by, reason=reason)
    answer = _answer(asking, deadline)
    if answer is not None:
        return Told(0, f"{robot}: STOPPED, latch {answer.id}; it stays so until `{RESET_COMMAND}`")
    refusal = asking.refusal
    if refusal is not None and refusal.engaged:
        return Told(
            ENGAGED, f"{robot}: STOPPED, latch {refusal.id}, but not for sure after a restart: {refusal.reason}"
        )
    if refusal is not None:
        why = f"{asking.key} answers that it has not stopped: {refusal.reason}"
    else:
        why = asking.fault or f"nobody answered {asking.key}"
    hint = others(watcher.session, robot)
    return Told(UNKNOWN, f"NOT CONFIRMED after {timeout:g} s: {why}; use the battery switch, then {HOW_TO_REACH}{hint}")


def reset(watcher: Watcher, by: str, timeout: float) -> Told:
    """Clear the latch that is engaged now, and no other. 0: no latch is engaged any more."""
    robot, deadline = watcher.robot, time.monotonic() + timeout
    heard = _listen(watcher, deadline)
    if not heard.states:
        return _silent(watcher, timeout)
    if len(heard.states) > 1:
        return Told(UNKNOWN, f"UNKNOWN: {_several(robot, heard)}")
    [state] = heard.states.values()
    if not state.engaged:
        return Told(RELEASED, f"{robot}: not engaged, nothing to clear; {_HOW_TO_DRIVE}")
    what = f"latch {state.id} of {robot}, engaged by {state.by}: {state.reason}"
    tick = _next_tick(watcher, heard, deadline)
    if tick is None:
        return Told(
            UNKNOWN,
            f"NOT CLEARED, {what}: the robot's clock is not heard on {key_of(robot, TICK)}; restart giraff_base",
        )
    asking = Asking(watcher.session, robot, ESTOP_RESET, EStopReset(by=by, id=state.id, tick=tick))
    answer = _answer(asking, deadline)
    if answer is None:
        return Told(
            UNKNOWN, f"NOT CONFIRMED after {timeout:g} s, {what}: {asking.fault or f'nobody answered {asking.key}'}"
        )
    if not answer.done or answer.engaged:
        return Told(ENGAGED, f"STILL ENGAGED, {what}: {answer.reason or f'latch {answer.id} has come since'}")
    return Told(RELEASED, f"cleared {what}\n{robot} may move again, and does not yet: {_HOW_TO_DRIVE}")


def status(watcher: Watcher, timeout: float) -> Told:
    """Whether it is engaged, by whom and why."""
    robot = watcher.robot
    heard = _listen(watcher, time.monotonic() + timeout)
    if not heard.states:
        return _silent(watcher, timeout)
    told = [
        f"{robot}: {'ENGAGED' if state.engaged else 'released'}, latch {state.id}"
        + (f", by {state.by}: {state.reason}" if state.by or state.reason else "")
        for state in heard.states.values()
    ]
    if len(heard.states) > 1:
        told.append(_several(robot, heard))
    return Told(ENGAGED if any(state.engaged for state in heard.states.values()) else RELEASED, "\n".join(told))


_HOW_TO_DRIVE: Final = "to drive, hold the hand level until it is armed"


class _Heard:
    """State of each base that answers to the name, and the robot's newest clock."""

    def __init__(self) -> None:
        self.states: dict[str, EStop] = {}
        self.tick: RobotTime | None = None

    def hear(self, topic: Topic[Any], key: str, sample: Sample, at_ns: int) -> None:
        del topic, key, at_ns
        if isinstance(sample, EStop):
            self.states[sample.instance] = sample
        elif isinstance(sample, Tick):
            self.tick = sample.time

    def announce(self, service: str, instance: str, *, present: bool) -> None:
        """What a service says counts here, not that it is there."""


def _listen(watcher: Watcher, deadline: float) -> _Heard:
    """The state of every base of this name; of none where none is heard before `deadline`."""
    heard = _Heard()
    watcher.listen((ESTOP, TICK))
    until = deadline
    while time.monotonic() < until:
        watcher.pass_on(heard)
        if heard.states and until == deadline:
            until = min(deadline, time.monotonic() + _TWO_PERIODS)
        time.sleep(_TURN)
    return heard


def _next_tick(watcher: Watcher, heard: _Heard, deadline: float) -> RobotTime | None:
    """A moment of the robot's clock that comes after all that is known of it so far; None: it has stopped."""
    watcher.pass_on(heard)
    later = _Heard()
    while later.tick is None and time.monotonic() < deadline:
        time.sleep(_TURN)
        watcher.pass_on(later)
    return later.tick


def _answer(asking: Asking[RequestT, AnswerT], deadline: float) -> AnswerT | None:
    while (now := time.monotonic()) < deadline:
        if (answer := asking.poll(now)) is not None:
            return answer
        time.sleep(_TURN)
    return None


def _silent(watcher: Watcher, timeout: float) -> Told:
    key, hint = key_of(watcher.robot, ESTOP), others(watcher.session, watcher.robot)
    return Told(UNKNOWN, f"UNKNOWN: nothing is heard on {key} after {timeout:g} s; {HOW_TO_REACH}{hint}")


def _several(robot: str, heard: _Heard) -> str:
    return f"{len(heard.states)} bases are called {robot} ({', '.join(heard.states)}); end all but one"
