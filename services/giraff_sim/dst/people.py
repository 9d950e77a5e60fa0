"""What humans do beside the joystick: a keyboard, a second joystick, and the command line's emergency stop."""

import math
import random
from typing import TYPE_CHECKING, Any, Final

import msgspec

from giraff_core.estop.latch import is_confirmed_stop
from giraff_core.retry import RetriedRequest
from giraff_core.timer import Timer
from giraff_joystick.service import Joystick
from giraff_keyboard.config import KeyboardConfig
from giraff_keyboard.service import Keyboard
from giraff_schemas.messages import RobotTime, Sample
from giraff_schemas.params import ParamSave, ParamSet
from giraff_schemas.requests import EStopAnswer, EStopEngage, EStopReset
from giraff_schemas.topics import (
    BASE,
    BATTERY,
    ESTOP,
    ESTOP_ENGAGE,
    ESTOP_RESET,
    GUARD,
    PARAM_SAVE,
    PARAM_SET,
    TICK,
    Query,
    Topic,
)
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_schemas.wire import TILT_LSB_PER_M_S2, TILT_PERIOD_MS, Frame, TickFrame, TiltFrame, TiltStatus
from giraff_sim.dst.hands import Fingers, RestlessHand
from giraff_sim.hosts.process import Process

if TYPE_CHECKING:
    from giraff_sim.dst.judging.judge import Judge

_POLL_HZ: Final = 20.0  # of the command line, for an answer
_NOISE: Final = 0.03  # m/s², of a hand and a sensor


def keyboard_user(process: Process, fingers: Fingers) -> Keyboard:
    """giraff_keyboard in a process of its own, with `fingers` at its terminal."""
    return Keyboard(process, KeyboardConfig(), process.loop.settings.robot, _Terminal(process, fingers))


class UnseenScreen:
    """A keyboard's terminal that nobody reads."""

    is_gone = False
    topics: tuple[Topic[Any], ...] = (BASE, GUARD, ESTOP, BATTERY)

    def descriptor(self) -> int | None:
        return None

    def on_sample(self, sample: Sample, now: float) -> None:
        """Nothing is shown of it."""

    def show(self, policy: object, stop: object, now: float) -> None:
        """Nothing to do."""


class _Terminal(UnseenScreen):
    """Where the fingers type."""

    def __init__(self, process: Process, fingers: Fingers) -> None:
        self._process = process
        self._fingers = fingers

    def read(self) -> bytes:
        """What was pressed until now. The next press wakes the process."""
        now_us = self._process.loop.agenda.now_us
        typed = b""
        while key := self._fingers.pressed(now_us * 1e-6):
            typed += key
        if typed:
            self._process.loop.observer.typed(self._process, typed)
        if (wait := self._fingers.wait(now_us * 1e-6)) is not None:
            self._process.wake(now_us + max(1, math.ceil(wait * 1e6)))
        return typed


def double(process: Process, chance: random.Random, seconds: float) -> Joystick:
    """A second joystick of the same name, in another hand, whose board is imitated."""
    settings = process.loop.settings
    process.imitate(settings.joystick.port, _TiltBoard(process, chance, RestlessHand(chance, seconds)))
    return Joystick(process, settings.joystick, settings.robot)


class _TiltBoard:
    """Frames as the joystick's board sends them."""

    fault = NO_TROUBLE
    opened = 1

    def __init__(self, process: Process, chance: random.Random, hand: RestlessHand) -> None:
        self._process = process
        self._chance = chance
        self._hand = hand
        self._tick: RobotTime | None = None
        self._timer = Timer(1000.0 / TILT_PERIOD_MS)
        self._seq = 0

    def descriptor(self) -> int | None:
        return None

    def poll(self, now: float) -> list[Frame]:
        loop = self._process.loop
        frames: list[Frame] = []
        if self._timer.due(now):
            frames.append(self._frame())
            loop.observer.read(self._process, frames[0])
        self._process.wake(loop.agenda.now_us + int(self._timer.wait(now) * 1e6) + 1)
        return frames

    def send(self, frame: Frame) -> None:
        if isinstance(frame, TickFrame):
            self._tick = RobotTime(epoch=frame.epoch, robot_ns=frame.robot_ns)

    def _frame(self) -> TiltFrame:
        loop = self._process.loop
        now_us = loop.agenda.now_us
        felt = self._hand.acceleration(now_us * 1e-6, loop.simulation.world.plant.pose)
        loop.observer.held(self._process, felt)
        x, y, z = (round((axis + self._chance.gauss(0.0, _NOISE)) * TILT_LSB_PER_M_S2) for axis in felt)
        self._seq += 1
        return TiltFrame(
            seq=self._seq,
            board_us=now_us,
            boot_id=1,
            tick_epoch=self._tick.epoch if self._tick else 0,
            tick_robot_ns=self._tick.robot_ns if self._tick else 0,
            x=x,
            y=y,
            z=z,
            status=TiltStatus.RUNNING,
            sys_status=6,
            sys_error=0,
            button=0,
            line_errors=0,
        )


class EStopOperator:
    """`giraff param set` and `giraff param save`, and who presses the emergency stop at the same moment as another."""

    link = None

    def __init__(self, process: Process) -> None:
        self._process = process
        self._asking: list[RetriedRequest[Any]] = []
        self.timers = (Timer(_POLL_HZ),)

    def set(self, service: str, name: str, value: float) -> None:
        """Ask for another value of a parameter."""
        self._ask(PARAM_SET.at(service), ParamSet(name=name, value=value, by=self._process.instance))

    def save(self, service: str) -> None:
        """Ask that all parameters of a service be kept as they are."""
        self._ask(PARAM_SAVE.at(service), ParamSave(by=self._process.instance))

    def engage(self, by: str = "") -> None:
        """Ask to stop, in the name of `by`; empty: in its own."""
        self._ask(ESTOP_ENGAGE, EStopEngage(by=by or self._process.instance, reason=Trouble("drill")))

    def turn(self, now: float) -> None:
        self.timers[0].due(now)
        self._asking = [asking for asking in self._asking if asking.poll(now) is None]

    def end(self) -> None:
        """Nothing is left to say."""

    def _ask(self, query: Query[Any, Any], request: msgspec.Struct) -> None:
        self._asking.append(self._process.ask(query, request, lambda _: True))
        self._process.wake()


class Button:
    """`giraff stop` and `giraff estop reset`: each asks again until base has answered."""

    link = None

    def __init__(self, process: Process, judge: "Judge") -> None:
        self._process = process
        self.instance = process.instance
        self._judge = judge
        self._states, self._ticks = process.inbox(ESTOP), process.inbox(TICK)
        self._asking: RetriedRequest[EStopAnswer] | None = None
        self._tick: RobotTime | None = None
        self._id = 0
        self.timers = (Timer(_POLL_HZ),)

    def engage(self) -> None:
        """Ask to stop."""
        asked = EStopEngage(by=self._process.instance, reason=Trouble("drill"))
        self._asking = self._process.ask(ESTOP_ENGAGE, asked, is_confirmed_stop)
        self._process.wake()

    def reset(self) -> None:
        """Ask to release the latch that was heard of last."""
        self._poll()
        asked = EStopReset(by=self._process.instance, id=self._id, tick=self._tick)
        self._judge.pressed_reset(asked)
        self._asking = self._process.ask(ESTOP_RESET, asked, lambda _: True)
        self._process.wake()

    def turn(self, now: float) -> None:
        self.timers[0].due(now)
        self._poll()
        if self._asking is not None and self._asking.poll(now) is not None:
            self._asking = None

    def end(self) -> None:
        """Nothing is left to say."""

    def _poll(self) -> None:
        for tick in self._ticks.pop_all():
            self._tick = tick.time
        for state in self._states.pop_all():
            self._id = state.id
