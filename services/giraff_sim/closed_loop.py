"""The whole robot in one process and simulated time: the services' policies around boards and world.

Each policy runs at its process's own rate and hears what that process would hear; the network between them is ideal.
The same seed gives the same run, to the byte.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable
from typing import Any, Final

import msgspec

from giraff_base.config import BaseConfig
from giraff_base.policy import BasePolicy
from giraff_guard.config import GuardConfig
from giraff_guard.policy import GuardPolicy
from giraff_joystick.config import JoystickConfig
from giraff_joystick.policy import JoystickPolicy
from giraff_node.pacing import Pacer
from giraff_node.robot import RobotConfig
from giraff_odometry.config import OdometryConfig
from giraff_odometry.policy import OdometryPolicy
from giraff_ranger.policy import RangerPolicy
from giraff_schemas.codec import stamped
from giraff_schemas.framing import Decoder, encode
from giraff_schemas.messages import DriveCommand, Range, RobotTime, Sample, Tick, Wheels
from giraff_schemas.topics import (
    BASE,
    CMD_VEL,
    GUARD,
    ODOM,
    OPERATOR_CMD_VEL,
    RANGE,
    TICK,
    TILT,
    WHEELS,
    SampleT,
    Topic,
)
from giraff_schemas.wire import BoardKind, Frame, RangeFrame, TiltFrame
from giraff_sim.simulation import Simulation

_BOOTED_NS: Final = 3_600_000_000_000  # the robot's host has been up for an hour when the simulation begins


class Settings(msgspec.Struct, frozen=True, kw_only=True):
    """Configuration of the robot and its services."""

    robot: RobotConfig
    joystick: JoystickConfig = JoystickConfig(port="joystick")
    base: BaseConfig = BaseConfig(port="base")
    guard: GuardConfig = GuardConfig()
    odometry: OdometryConfig = OdometryConfig()


class ClosedLoop:
    """Step it, kill and start services, and look at the newest sample of each key."""

    def __init__(self, simulation: Simulation, settings: Settings) -> None:
        self.simulation = simulation
        self.settings = settings
        self.newest: dict[str, Any] = {}
        """By key, as the topics table has it."""
        self._decoders: dict[BoardKind, Decoder] = defaultdict(Decoder)
        self._started = 0
        self._services: dict[str, Service] = {}
        for name in SERVICES:
            self.start(name)

    @property
    def robot_ns(self) -> int:
        """The robot's clock."""
        return _BOOTED_NS + self.simulation.now_us * 1000

    def start(self, name: str) -> None:
        """Start the service `name`, anew if it was killed."""
        self._started += 1
        self._services[name] = SERVICES[name](self, f"{name}-{self._started}", self._started)

    def kill(self, name: str) -> None:
        """End the service `name` as SIGKILL would."""
        del self._services[name]

    def step(self) -> None:
        """Advance by a simulated millisecond."""
        self.simulation.step()
        for service in tuple(self._services.values()):
            service.turn(self.simulation.now_us * 1e-6)

    def run(self, seconds: float) -> None:
        end = self.simulation.now_us + round(seconds * 1e6)
        while self.simulation.now_us < end:
            self.step()

    def deliver(self, key: str, sample: Sample) -> None:
        self.newest[key] = sample
        for service in self._services.values():
            service.hear(sample)

    def receive(self, kind: BoardKind) -> list[Frame]:
        return self._decoders[kind].feed(self.simulation.read(kind))

    def send(self, kind: BoardKind, frame: Frame) -> None:
        self.simulation.write(kind, encode(frame.pack()))


class Service:
    """One policy in the place of its process."""

    def __init__(self, loop: ClosedLoop, instance: str) -> None:
        self.loop = loop
        self._instance = instance
        self._sequences: dict[str, int] = defaultdict(int)

    def turn(self, now: float) -> None:
        """Called every millisecond. `now`: simulated s."""

    def hear(self, sample: Sample) -> None:
        """Called with each sample, at the moment it is published."""

    def say(self, topic: Topic[SampleT], sample: SampleT) -> None:
        seq = self._sequences[topic.key]
        self._sequences[topic.key] += 1
        self.loop.deliver(topic.key, stamped(sample, seq, self.loop.robot_ns, self._instance))


class Joystick(Service):
    def __init__(self, loop: ClosedLoop, instance: str, _number: int) -> None:
        super().__init__(loop, instance)
        self._config = loop.settings.joystick
        self._policy = JoystickPolicy(self._config, loop.settings.robot)
        self._pace = Pacer(OPERATOR_CMD_VEL.rate_hz)

    def hear(self, sample: Sample) -> None:
        if isinstance(sample, Tick):
            self.loop.send(BoardKind.JOYSTICK, self._policy.on_tick(sample))

    def turn(self, now: float) -> None:
        for frame in self.loop.receive(BoardKind.JOYSTICK):
            if isinstance(frame, TiltFrame):
                self.say(TILT, self._policy.on_frame(frame, now))
        if self._pace.due(now):
            self.say(OPERATOR_CMD_VEL.at(self._config.operator), self._policy.command(now))


class Ranger(Service):
    def __init__(self, loop: ClosedLoop, instance: str, _number: int) -> None:
        super().__init__(loop, instance)
        self._policy = RangerPolicy(loop.settings.robot)

    def hear(self, sample: Sample) -> None:
        if isinstance(sample, Tick):
            self.loop.send(BoardKind.RANGER, self._policy.on_tick(sample))

    def turn(self, now: float) -> None:  # noqa: ARG002  its board paces it
        for frame in self.loop.receive(BoardKind.RANGER):
            if isinstance(frame, RangeFrame) and (sample := self._policy.on_frame(frame)) is not None:
                self.say(RANGE.at(sample.sensor), sample)


class Guard(Service):
    def __init__(self, loop: ClosedLoop, instance: str, _number: int) -> None:
        super().__init__(loop, instance)
        self._policy = GuardPolicy(loop.settings.guard, loop.settings.robot)
        self._pace, self._state_pace = Pacer(CMD_VEL.rate_hz), Pacer(GUARD.rate_hz)

    def hear(self, sample: Sample) -> None:
        match sample:
            case Tick():
                self._policy.on_tick(sample)
            case Range():
                self._policy.on_range(sample)
            case Wheels():
                self._policy.on_wheels(sample)
            case DriveCommand():
                self._policy.on_command(sample, self.loop.robot_ns)

    def turn(self, now: float) -> None:
        if self._pace.due(now):
            command, state = self._policy.decide(self.loop.robot_ns)
            self.say(CMD_VEL, command)
            if self._state_pace.due(now):
                self.say(GUARD, state)


class Base(Service):
    def __init__(self, loop: ClosedLoop, instance: str, number: int) -> None:
        super().__init__(loop, instance)
        self._epoch = number
        self._policy = BasePolicy(loop.settings.base, loop.settings.robot)
        self._policy.on_link_opened(session=number)
        self._tick_pace, self._state_pace = Pacer(TICK.rate_hz), Pacer(BASE.rate_hz)

    def hear(self, sample: Sample) -> None:
        if isinstance(sample, CMD_VEL.schema):
            self._policy.on_command(sample, self._now)

    def turn(self, now: float) -> None:
        if self._tick_pace.due(now):
            self.say(TICK, Tick(epoch=self._epoch, robot_ns=self.loop.robot_ns))
        for wheels in self._policy.on_frames(self.loop.receive(BoardKind.BASE), self._now):
            self.say(WHEELS, wheels)
        if (frame := self._policy.next_frame(self._now)) is not None:
            self.loop.send(BoardKind.BASE, frame)
        if self._state_pace.due(now):
            self.say(BASE, self._policy.state())

    @property
    def _now(self) -> RobotTime:
        return RobotTime(epoch=self._epoch, robot_ns=self.loop.robot_ns)


class Odometry(Service):
    def __init__(self, loop: ClosedLoop, instance: str, _number: int) -> None:
        super().__init__(loop, instance)
        self._policy = OdometryPolicy(loop.settings.odometry, loop.settings.robot)

    def hear(self, sample: Sample) -> None:
        if isinstance(sample, Wheels) and (odometry := self._policy.on_wheels(sample)) is not None:
            self.say(ODOM, odometry)


SERVICES: Final[dict[str, Callable[[ClosedLoop, str, int], Service]]] = {
    "joystick": Joystick,
    "ranger": Ranger,
    "guard": Guard,
    "base": Base,
    "odometry": Odometry,
}
