"""Processes that humans work beside the joystick: a keyboard, a stop button, and a second joystick."""

from __future__ import annotations

import math
import random
from typing import TYPE_CHECKING, Final

from giraff_keyboard.config import KeyboardConfig
from giraff_keyboard.policy import KeyboardPolicy
from giraff_node.pacing import Pacer
from giraff_schemas.messages import EStop, EStopAnswer, EStopEngage, EStopReset, Lease, RobotTime, Tick
from giraff_schemas.topics import OPERATOR_CMD_VEL, TILT
from giraff_schemas.wire import TILT_LSB_PER_M_S2, TILT_PERIOD_MS, TiltFrame, TiltStatus
from giraff_sim.dst.hands import Fingers, RestlessHand
from giraff_sim.hosts.process import Process

if TYPE_CHECKING:
    from giraff_sim.closed_loop import ClosedLoop
    from giraff_sim.dst.judge import Judge
    from giraff_sim.hosts.host import Host

_ASKS_EVERY: Final = 0.2  # s, until it is answered
_NOISE: Final = 0.03  # m/s², of a hand and a sensor


class Keyboard(Process):
    """giraff_keyboard, with fingers in the place of the terminal."""

    def __init__(self, loop: ClosedLoop, host: Host, instance: str, judge: Judge, fingers: Fingers) -> None:
        super().__init__(loop, host, instance)
        config = KeyboardConfig()
        self._policy = KeyboardPolicy(config, loop.settings.robot, instance)
        self._judge, self._fingers = judge, fingers
        self._ticks, self._leases = self._inbox(Tick, limit=1), self._inbox(Lease, limit=10)
        self._topic = OPERATOR_CMD_VEL.at(config.operator)
        self._pace = Pacer(OPERATOR_CMD_VEL.rate_hz)
        self._pacers = (self._pace,)
        self._pressed_us = 0

    def turn(self, now: float) -> None:
        now_us = self.loop.agenda.now_us
        pressed = False
        while (key := self._fingers.pressed(now_us * 1e-6)) is not None:
            pressed = True
            self._pressed_us = now_us
            self._policy.on_key(key, now)
        for tick in self._ticks.take():
            self._policy.on_tick(tick, now)
        for lease in self._leases.take():
            self._policy.on_lease(lease)
        if self._pace.due(now) or pressed:
            command = self._policy.command(now)
            self._judge.measured(self, now_us if command.neutral else self._pressed_us)
            self._say(self._topic, command)
        if (wait := self._fingers.wait(now_us * 1e-6)) is not None:
            self.wake(now_us + max(1, math.ceil(wait * 1e6)))


class Double(Process):
    """A second joystick of the same name, whose board is imitated: another hand, and frames as the board sends them."""

    def __init__(self, loop: ClosedLoop, host: Host, instance: str, chance: random.Random, seconds: float) -> None:
        super().__init__(loop, host, instance)
        settings = loop.settings
        self._policy = loop.policies.joystick(settings.joystick, settings.robot, instance)
        self._chance = chance
        self._hand = RestlessHand(chance, seconds)
        self._tick: RobotTime | None = None
        self._ticks, self._leases = self._inbox(Tick, limit=1), self._inbox(Lease, limit=10)
        self._topic = OPERATOR_CMD_VEL.at(settings.joystick.operator)
        self._pace, self._frame_pace = Pacer(OPERATOR_CMD_VEL.rate_hz), Pacer(1000.0 / TILT_PERIOD_MS)
        self._pacers = (self._pace, self._frame_pace)
        self._seq = 0

    def turn(self, now: float) -> None:
        if self._frame_pace.due(now):
            frame = self._frame()
            self.loop.observer.read(self, frame)
            self._say(TILT, self._policy.on_frame(frame, now))
        for lease in self._leases.take():
            self._policy.on_lease(lease)
        for tick in self._ticks.take():
            self._policy.on_tick(tick, now)
            self._tick = tick.time
        if self._pace.due(now):
            self._say(self._topic, self._policy.command(now))

    def _frame(self) -> TiltFrame:
        now_us = self.loop.agenda.now_us
        felt = self._hand.acceleration(now_us * 1e-6, self.loop.simulation.world.plant.pose)
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


class Button(Process):
    """`giraff estop engage` and `giraff estop reset`: each asks again until base has answered."""

    def __init__(self, loop: ClosedLoop, host: Host, instance: str, judge: Judge) -> None:
        super().__init__(loop, host, instance)
        self._judge = judge
        self._answers, self._states = self._queue(EStopAnswer), self._queue(EStop)
        self._ticks = self._queue(Tick)
        self._asks_again = 0.0
        self._asks: EStopEngage | EStopReset | None = None
        self._tick: RobotTime | None = None
        self._id = 0

    def engage(self) -> None:
        self._ask(EStopEngage(by=self.instance, reason="drill"))

    def reset(self) -> None:
        """Ask to release the latch that was heard of last."""
        self._hear()
        reset = EStopReset(by=self.instance, id=self._id, tick=self._tick)
        self._judge.pressed_reset(reset)
        self._ask(reset)

    def turn(self, now: float) -> None:
        self._hear()
        for _ in self._answers.take():
            self._asks = None
        if self._asks is not None and now >= self._asks_again:
            self._asks_again = now + _ASKS_EVERY
            self.loop.network.publish(self, self._asks)

    def _ask(self, request: EStopEngage | EStopReset) -> None:
        for _ in self._answers.take():
            pass  # of an earlier request
        self._asks, self._asks_again = request, 0.0
        self.wake()

    def _hear(self) -> None:
        for tick in self._ticks.take():
            self._tick = tick.time
        for state in self._states.take():
            self._id = state.id
