"""Ways to break the robot that change what it does, and not what it says: each is to be found by the judge."""

from collections import deque
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any, Final, NamedTuple

import msgspec

from giraff_base.policy import BasePolicy
from giraff_base.service import Base
from giraff_core.io import IO
from giraff_core.live import Live
from giraff_core.operator import Fault, Wish
from giraff_core.senses import Sensed
from giraff_guard.policy import GuardPolicy
from giraff_guard.service import Guard
from giraff_joystick.policy import JoystickPolicy
from giraff_joystick.service import Joystick
from giraff_ranger.policy import RangerPolicy
from giraff_ranger.service import Ranger
from giraff_schemas.messages import Range, RobotTime
from giraff_schemas.wire import Frame, RangeFrame, SpeedFrame
from giraff_sim.board import BUILD
from giraff_sim.settings import Services
from tests.firmware.builds import robot_with_fault

_LATE: Final = 0.4  # s


def _moves(asked: Wish | Fault) -> bool:
    return isinstance(asked, Wish) and (asked.linear_x, asked.angular_z) != (0.0, 0.0)


class LateJoystick(JoystickPolicy):
    """Tells the first 0.4 s of a tilt as neutral."""

    _level_at = 0.0

    def poll(self, now: float) -> Wish | Fault:
        asked = super().poll(now)
        if not _moves(asked):
            self._level_at = now
        if isinstance(asked, Fault) or now - self._level_at >= _LATE:
            return asked
        return asked._replace(linear_x=0.0, angular_z=0.0)


class LingeringJoystick(JoystickPolicy):
    """Goes on with a tilt for a second after the hand is level."""

    _tilted: tuple[float, Wish] | None = None

    def poll(self, now: float) -> Wish | Fault:
        asked = super().poll(now)
        if isinstance(asked, Wish) and _moves(asked):
            self._tilted = now, asked
        elif self._tilted is not None and isinstance(asked, Wish) and now - self._tilted[0] < 1.0:
            return self._tilted[1]._replace(tick=asked.tick)
        return asked


class InvertedJoystick(JoystickPolicy):
    """Drives backward where the hand points forward."""

    def poll(self, now: float) -> Wish | Fault:
        asked = super().poll(now)
        return asked._replace(linear_x=-asked.linear_x) if isinstance(asked, Wish) else asked


class LongRanger(RangerPolicy):
    """Tells twice each range."""

    def on_frame(self, frame: RangeFrame) -> Range | None:
        sample = super().on_frame(frame)
        if sample is None or sample.range is None:
            return sample
        return msgspec.structs.replace(sample, range=2.0 * sample.range)


class LateRanger(RangerPolicy):
    """Tells what it heard five readings ago, under the newest tick."""

    def __init__(self, *given: Any) -> None:
        super().__init__(*given)
        self._told: dict[str, deque[Range]] = {}

    def on_frame(self, frame: RangeFrame) -> Range | None:
        sample = super().on_frame(frame)
        if sample is None:
            return None
        told = self._told.setdefault(sample.sensor, deque(maxlen=6))
        told.append(sample)
        return msgspec.structs.replace(told[0], tick=sample.tick)


class OptimisticGuard(GuardPolicy):
    """Believes everything to be 0.6 m farther away."""

    def on_sensed(self, reading: Sensed, robot_ns: int) -> bool:
        if isinstance(reading, Range) and reading.range is not None:
            reading = msgspec.structs.replace(reading, range=reading.range + 0.6)
        return super().on_sensed(reading, robot_ns)


class TurnedGuard(GuardPolicy):
    """Takes the sensors in front for the one behind, and the other way round."""

    def on_sensed(self, reading: Sensed, robot_ns: int) -> bool:
        names = {"front_left": ["rear"], "front_right": [], "rear": ["front_left", "front_right"]}
        hurries = False
        assert isinstance(reading, Range)
        for name in names[reading.sensor]:
            hurries |= super().on_sensed(msgspec.structs.replace(reading, sensor=name), robot_ns)
        return hurries


class HalfGuard(GuardPolicy):
    """Takes what the left sensor hears for what the right one does, too."""

    def on_sensed(self, reading: Sensed, robot_ns: int) -> bool:
        if reading.sensor == "front_right":
            return False
        hurries = super().on_sensed(reading, robot_ns)
        if isinstance(reading, Range) and reading.sensor == "front_left":
            hurries |= super().on_sensed(msgspec.structs.replace(reading, sensor="front_right"), robot_ns)
        return hurries


class CloseGuard(GuardPolicy):
    """Keeps no margin worth the name."""

    def __init__(self, live: Live[Any], *rest: Any, **named: Any) -> None:
        super().__init__(Live(msgspec.structs.replace(live.config, margin=0.02, memory_margin=0.01)), *rest, **named)


class SuddenBase(BasePolicy):
    """Ramps no start."""

    def __init__(self, live: Live[Any], *rest: Any) -> None:
        sudden = msgspec.structs.replace(live.config, linear_acceleration=5.0, angular_acceleration=20.0)
        super().__init__(Live(sudden), *rest)


class MirroredBase(BasePolicy):
    """Gives the left wheel's speed to the right one."""

    def next_frame(self, now: RobotTime) -> Frame | None:
        frame = super().next_frame(now)
        if isinstance(frame, SpeedFrame):
            return msgspec.structs.replace(frame, left_um_s=frame.right_um_s, right_um_s=frame.left_um_s)
        return frame


class LazyBase(BasePolicy):
    """Goes on for 0.3 s after it should stop."""

    _asked: tuple[int, int, int] = 0, 0, 0

    def next_frame(self, now: RobotTime) -> Frame | None:
        frame = super().next_frame(now)
        if isinstance(frame, SpeedFrame):
            if frame.left_um_s or frame.right_um_s:
                self._asked = now.robot_ns, frame.left_um_s, frame.right_um_s
            elif now.robot_ns - self._asked[0] < 300_000_000:
                return msgspec.structs.replace(frame, left_um_s=self._asked[1], right_um_s=self._asked[2])
        return frame


class LyingWriter:
    """Says that it wrote, and does not."""

    def __init__(self) -> None:
        self._news = deque[str]()

    def save(self, data: bytes) -> None:
        del data
        self._news.append("")

    def outcome(self) -> str | None:
        return self._news.popleft() if self._news else None


def forgetful_base(io: IO, *given: Any) -> Base:
    """Its emergency stop is never on disk."""
    store: Any = io.store
    store.writer = lambda name: LyingWriter()  # noqa: ARG005
    return Base(io, *given)


class Break(NamedTuple):
    """What is broken, and a seed that shows it: the first one, as tests/campaign/test_breaks.py finds it."""

    name: str
    seed: int
    rule: str
    """Letter of what is violated in it."""
    services: Services = Services()
    build: Callable[[], Path] = lambda: BUILD


_MOTORS: Final = ("hal_motor_pwm", "hal_motor_direction", "hal_motor_off")

BREAKS: Final = (
    Break("joystick late", 2, "c", Services(joystick=partial(Joystick, policy=LateJoystick))),
    Break("board triple", 0, "g", build=lambda: robot_with_fault("triple_pwm", "hal_motor_pwm")),
    Break("board swapped", 0, "g", build=lambda: robot_with_fault("swapped_motors", *_MOTORS)),
    Break("joystick inverted", 0, "c", Services(joystick=partial(Joystick, policy=InvertedJoystick))),
    Break("ranges doubled", 34, "e", Services(ranger=partial(Ranger, policy=LongRanger))),
    Break("guard optimistic", 5, "e", Services(guard=partial(Guard, policy=OptimisticGuard))),
    Break("base sudden", 0, "g", Services(base=partial(Base, policy=SuddenBase))),
    Break("guard turned", 5, "e", Services(guard=partial(Guard, policy=TurnedGuard))),
    Break("joystick lingering", 0, "c", Services(joystick=partial(Joystick, policy=LingeringJoystick))),
    Break("ranges late", 57, "e", Services(ranger=partial(Ranger, policy=LateRanger))),
    Break("guard half", 61, "e", Services(guard=partial(Guard, policy=HalfGuard))),
    Break("guard close", 5, "e", Services(guard=partial(Guard, policy=CloseGuard))),
    Break("base mirrored", 0, "c", Services(base=partial(Base, policy=MirroredBase))),
    Break("base lazy", 0, "b", Services(base=partial(Base, policy=LazyBase))),
    Break("base forgetful", 1, "d", Services(base=forgetful_base)),
    Break("board lingering", 0, "g", build=lambda: robot_with_fault("lingering_motors", "hal_motor_off")),
)
