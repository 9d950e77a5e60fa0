"""Policies with one rule broken each, and the services that go by them."""

from functools import partial
from typing import Any, Final

import msgspec

from giraff_base.policy import BasePolicy
from giraff_base.service import Base
from giraff_core.estop.latch import RELEASED
from giraff_core.live import Live
from giraff_core.operator import Fault, Wish
from giraff_core.senses import Sensed
from giraff_guard.policy import GuardPolicy
from giraff_guard.service import Guard
from giraff_joystick.policy import JoystickPolicy
from giraff_joystick.service import Joystick
from giraff_schemas.messages import DriveCommand, GuardedCommand, Range, RobotTime, Tick, Tilt
from giraff_schemas.requests import EStopAnswer, EStopEngage, EStopReset
from giraff_schemas.wire import TickFrame, TiltFrame
from giraff_sim.settings import Services

FOR_EVER: Final = 2.0  # s; as long as a budget can be, and longer than any fault here lasts


def broken(
    *,
    joystick: type[JoystickPolicy] = JoystickPolicy,
    guard: type[GuardPolicy] = GuardPolicy,
    base: type[BasePolicy] = BasePolicy,
) -> Services:
    """The services that ship, with other policies in them."""
    return Services(
        joystick=partial(Joystick, policy=joystick), guard=partial(Guard, policy=guard), base=partial(Base, policy=base)
    )


class PatientBase(BasePolicy):
    """Finds nothing too old."""

    def __init__(self, live: Live[Any], *rest: Any) -> None:
        names = ("operator_budget", "guard_budget", "range_budget", "disarm_time")
        super().__init__(Live(msgspec.structs.replace(live.config, **dict.fromkeys(names, FOR_EVER))), *rest)


class PatientGuard(GuardPolicy):
    """Finds nothing too old."""

    def __init__(self, live: Live[Any], *rest: Any, **named: Any) -> None:
        names = ("operator_budget", "range_budget", "operator_release", "fault_release")
        super().__init__(Live(msgspec.structs.replace(live.config, **dict.fromkeys(names, FOR_EVER))), *rest, **named)


class RenewingJoystick(JoystickPolicy):
    """Gives each command the newest tick it has heard, as if it had been measured now."""

    _newest: Tick | None = None

    def on_tick(self, tick: Tick, now: float) -> TickFrame | None:
        self._newest = tick
        return super().on_tick(tick, now)

    def poll(self, now: float) -> Wish | Fault:
        self._heard = now  # and does not mind that its board is silent
        asked = super().poll(now)
        return asked._replace(tick=self._newest.time) if self._newest else asked


class NumbJoystick(JoystickPolicy):
    """Never feels its button."""

    def on_frame(self, frame: TiltFrame, now: float) -> Tilt:
        return super().on_frame(msgspec.structs.replace(frame, button=0), now)


class HastyBase(BasePolicy):
    """Arms by a neutral of next to no length."""

    def __init__(self, live: Live[Any], *rest: Any) -> None:
        super().__init__(Live(msgspec.structs.replace(live.config, arm_time=0.05)), *rest)


class EagerBase(BasePolicy):
    """Needs no neutral at all: takes any hand for one that is level."""

    def on_command(self, command: GuardedCommand, now: RobotTime) -> None:
        super().on_command(command, now)
        self._permission.arming.armed = True


class OpenGuard(GuardPolicy):
    """Obeys whoever wishes to drive, in the name of the holder, and no level hand."""

    def on_command(self, command: DriveCommand, robot_ns: int) -> bool:
        authority = self._lease_holder
        if command.neutral and authority.command is not None and not authority.command.neutral:
            return False
        hurries = super().on_command(command, robot_ns)
        if authority.holder and not command.neutral:
            authority.command = msgspec.structs.replace(command, lease_counter=authority.counter)
        return hurries


class DeafBase(BasePolicy):
    """Confirms an emergency stop, and goes on."""

    def on_engage(self, asked: EStopEngage, now: RobotTime) -> EStopAnswer:
        del asked, now
        return EStopAnswer(done=True, engaged=True, id=1)


class ForgivingBase(BasePolicy):
    """Lets any reset clear any latch, however old it is."""

    def on_reset(self, reset: EStopReset, now: RobotTime) -> EStopAnswer:
        return super().on_reset(msgspec.structs.replace(reset, id=self.latch.id, tick=now), now)


class AmnesiacBase(BasePolicy):
    """Starts released whatever was kept, and releases the board, too."""

    def __init__(self, live: Live[Any], robot: Any, latch: Any, *rest: Any) -> None:
        del latch
        super().__init__(live, robot, RELEASED, *rest)

    def on_link_opened(self, session: int) -> None:
        super().on_link_opened(session)
        self._drive.release()


class BlindGuard(GuardPolicy):
    """Takes what is near for far."""

    def on_sensed(self, reading: Sensed, robot_ns: int) -> bool:
        if isinstance(reading, Range) and reading.range is not None:
            reading = msgspec.structs.replace(reading, range=reading.range + 2.0)
        return super().on_sensed(reading, robot_ns)


class GrudgingGuard(GuardPolicy):
    """Never forgets that something may touch a sensor."""

    _lost = False

    def decide(self, robot_ns: int, heard: tuple[int, ...] = ()) -> GuardedCommand:
        command = super().decide(robot_ns, heard)
        self._lost = self._lost or "lost something" in str(self.state().forward.reason)
        return msgspec.structs.replace(command, linear_x=min(0.0, command.linear_x)) if self._lost else command


class TimidGuard(GuardPolicy):
    """Never lets the robot go forward."""

    def decide(self, robot_ns: int, heard: tuple[int, ...] = ()) -> GuardedCommand:
        command = super().decide(robot_ns, heard)
        return msgspec.structs.replace(command, linear_x=min(0.0, command.linear_x), angular_z=0.0)
