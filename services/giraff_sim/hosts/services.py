"""The services as processes: each `turn` is the loop of its `main`, in the same order and at the same rate."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from giraff_node.estop import EStopLatch
from giraff_node.pacing import Pacer
from giraff_schemas.messages import (
    DriveCommand,
    EStopEngage,
    EStopReset,
    GuardedCommand,
    Lease,
    Range,
    RobotTime,
    Tick,
    Wheels,
)
from giraff_schemas.topics import (
    BASE,
    CMD_VEL,
    ESTOP,
    GUARD,
    LEASE,
    ODOM,
    OPERATOR_CMD_VEL,
    RANGE,
    TICK,
    TILT,
    WHEELS,
)
from giraff_schemas.wire import BASE_BAUD, JOYSTICK_BAUD, RANGER_BAUD, BoardKind, Frame, RangeFrame, TiltFrame
from giraff_sim.hosts.process import Process

if TYPE_CHECKING:
    from giraff_sim.closed_loop import ClosedLoop
    from giraff_sim.hosts.host import Host

_MISSING: Final = EStopLatch(engaged=True, id=0, by="base", reason="nothing is on disk")


class Joystick(Process):
    def __init__(self, loop: ClosedLoop, host: Host, instance: str, _number: int) -> None:
        super().__init__(loop, host, instance)
        settings = loop.settings
        self._policy = loop.policies.joystick(settings.joystick, settings.robot, instance)
        self._port = self._link(settings.joystick.port, JOYSTICK_BAUD, BoardKind.JOYSTICK)
        self._ticks, self._leases = self._inbox(Tick, limit=1), self._inbox(Lease, limit=10)
        self._topic = OPERATOR_CMD_VEL.at(settings.joystick.operator)
        self._pace = Pacer(OPERATOR_CMD_VEL.rate_hz)
        self._pacers = (self._pace,)

    def turn(self, now: float) -> None:
        for frame in self._port.poll(now):
            if isinstance(frame, TiltFrame):
                self.loop.observer.read(self, frame)
                self._say(TILT, self._policy.on_frame(frame, now))
        for lease in self._leases.take():
            self._policy.on_lease(lease)
        for tick in self._ticks.take():
            if (down := self._policy.on_tick(tick, now)) is not None:
                self._write(self._port, down)
        if self._pace.due(now):
            self._say(self._topic, self._policy.command(now))


class Ranger(Process):
    def __init__(self, loop: ClosedLoop, host: Host, instance: str, _number: int) -> None:
        super().__init__(loop, host, instance)
        self._policy = loop.policies.ranger(loop.settings.robot)
        self._port = self._link(loop.settings.ranger.port, RANGER_BAUD, BoardKind.RANGER)
        self._ticks = self._inbox(Tick, limit=1)
        self._topics = {name: RANGE.at(name) for name in loop.settings.robot.sensors}

    def turn(self, now: float) -> None:
        for frame in self._port.poll(now):
            if isinstance(frame, RangeFrame):
                self.loop.observer.read(self, frame)
                if (sample := self._policy.on_frame(frame)) is not None:
                    self._say(self._topics[sample.sensor], sample)
        for tick in self._ticks.take():
            if (down := self._policy.on_tick(tick, now)) is not None:
                self._write(self._port, down)


class Guard(Process):
    def __init__(self, loop: ClosedLoop, host: Host, instance: str, number: int) -> None:
        super().__init__(loop, host, instance)
        self._policy = loop.policies.guard(loop.settings.guard, loop.settings.robot, first_lease=number * 1000)
        # Their arrival wakes the real loop too, which then waits on for its pace.
        self._ticks, self._ranges = self._queue(Tick), self._queue(Range)
        self._wheels, self._commands = self._queue(Wheels), self._queue(DriveCommand)
        self._pace, self._state_pace, self._lease_pace = (Pacer(topic.rate_hz) for topic in (CMD_VEL, GUARD, LEASE))
        self._pacers = (self._pace,)
        self._counter = 0

    def turn(self, now: float) -> None:
        if not self._pace.due(now):
            return
        policy, observer, robot_ns = self._policy, self.loop.observer, self.host.boottime_ns()
        for tick in self._ticks.take():
            policy.on_tick(tick, robot_ns)
        for reading in self._ranges.take():
            observer.heard(self, reading)
            policy.on_range(reading, robot_ns)
        for wheels in self._wheels.take():
            policy.on_wheels(wheels, robot_ns)
        for command in self._commands.take():
            observer.heard(self, command)
            policy.on_command(command, robot_ns)
        passed, state, lease = policy.decide(robot_ns)
        self._say(CMD_VEL, passed)
        if self._lease_pace.due(now) or lease.counter != self._counter:
            self._counter = lease.counter
            self._say(LEASE, lease)
        if self._state_pace.due(now):
            self._say(GUARD, state)


class Base(Process):
    def __init__(self, loop: ClosedLoop, host: Host, instance: str, number: int) -> None:
        super().__init__(loop, host, instance)
        self._epoch = number
        self._on_disk = host.disk.get("estop", _MISSING)
        self._policy = loop.policies.base(loop.settings.base, loop.settings.robot, self._on_disk)
        self._port = self._link(loop.settings.base.port, BASE_BAUD, BoardKind.BASE)
        self._opened = 0
        self._commands = self._inbox(GuardedCommand)
        self._engages, self._resets = self._inbox(EStopEngage, limit=20), self._inbox(EStopReset, limit=20)
        self._tick_pace, self._state_pace, self._estop_pace = (Pacer(each.rate_hz) for each in (TICK, BASE, ESTOP))
        self._pacers = (self._tick_pace, self._state_pace)

    def turn(self, now: float) -> None:
        policy, observer = self._policy, self.loop.observer
        if self._tick_pace.due(now):
            self._say(TICK, Tick(epoch=self._epoch, robot_ns=self.host.boottime_ns()))
        frames = self._port.poll(now)
        if self._port.opened != self._opened:
            self._opened = self._port.opened
            observer.opened(self)
            policy.on_link_opened(session=self._epoch * 1000 + self._opened)
        if self._port.fault:
            policy.on_link_lost(self._port.fault)
        robot_time = RobotTime(epoch=self._epoch, robot_ns=self.host.boottime_ns())
        self._stop_and_release(robot_time)
        for command in self._commands.take():
            observer.heard(self, command)
            policy.on_command(command, robot_time)
        self._read(frames, robot_time)
        if (answer := policy.next_frame(robot_time)) is not None:
            self._write(self._port, answer)
        changed = policy.latch is not self._on_disk
        if changed:
            self._on_disk = self.host.disk["estop"] = policy.latch
        if changed or self._estop_pace.due(now):
            self._say(ESTOP, policy.estop())
        if self._state_pace.due(now):
            self._say(BASE, policy.state())

    def _read(self, frames: list[Frame], now: RobotTime) -> None:
        for frame in frames:
            self.loop.observer.read(self, frame)
        for sample in self._policy.on_frames(frames, now):
            self._say(WHEELS, sample)

    def _stop_and_release(self, now: RobotTime) -> None:
        """Answer what is asked of the emergency stop; this disk is written at once."""
        for engage in self._engages.take():
            self.loop.observer.heard(self, engage)
            self.loop.network.publish(self, self._policy.on_engage(engage, now))
        for reset in self._resets.take():
            self.loop.observer.heard(self, reset)
            self.loop.network.publish(self, self._policy.on_reset(reset, now))


class Odometry(Process):
    def __init__(self, loop: ClosedLoop, host: Host, instance: str, _number: int) -> None:
        super().__init__(loop, host, instance)
        self._policy = loop.policies.odometry(loop.settings.odometry, loop.settings.robot)
        self._wheels = self._inbox(Wheels)

    def turn(self, now: float) -> None:
        del now
        for wheels in self._wheels.take():
            if (odometry := self._policy.on_wheels(wheels)) is not None:
                self._say(ODOM, odometry)
