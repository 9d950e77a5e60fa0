"""Has giraff_motion drive a robot ahead and back, and hears its wheels meanwhile."""

import math
import time
from collections.abc import Callable, Mapping
from contextlib import closing
from typing import Any, Final

from giraff_core.motion.result import MotionResult
from giraff_core.motion.wish import Wish
from giraff_node.motion_client import TURN, MotionClient
from giraff_schemas.messages import Battery, GuardedCommand, Lease, Sample, Wheels
from giraff_schemas.motion import Move
from giraff_schemas.topics import BATTERY, CMD_VEL, LEASE, WHEELS, Topic
from giraff_setup.wheels.speed.fit import DISTANCE, SPEED
from giraff_tools.network.connection import RobotConnection
from giraff_tools.network.limits import ask_base
from giraff_tools.terminal.signals import StopSignal

PATIENCE: Final = 3.0
"""s for wheels, for the robot's clock, and for the lease that motion gives back."""

_SILENCE: Final = 0.5  # s


class UnfitDriveError(Exception):
    """The drive is not one to judge the motors by. The message says why, and the remedy."""


class SpeedDrive:
    """One robot. Motion drives it: lease, arming, stops and the way that is free are motion's and guard's."""

    def __init__(self, connection: RobotConnection, by: str) -> None:
        """`by`: the person to name to others who ask who it was."""
        self._connection, self._by = connection, by
        self._lease: Lease | None = None
        self._granted: Lease | None = None
        """The lease under which it moves."""
        self._client: MotionClient | None = None
        self._slowed = ""
        self._heard_at = -math.inf
        self.wheels: list[Wheels] = []
        """All of the drive."""
        self.voltage: float | None = None
        """V of the battery while it drives. None: base does not tell it."""
        for topic in (WHEELS, CMD_VEL, LEASE, BATTERY):
            connection.subscribe(topic)

    def wait(self) -> bool:
        """Return whether its wheels are heard."""
        return self._wait(lambda: bool(self.wheels))

    def goes_by(self, gains: Mapping[str, float]) -> bool:
        """Return True if base says that these settings of `[base.drive.speed_control]` are in force."""
        answer = ask_base(self._connection).wait(time.monotonic() + PATIENCE)
        values = {param.name: param.value for param in answer.params} if answer else {}
        return bool(gains.items() <= values.get("drive.speed_control", {}).items())

    def drive(self) -> None:
        """Drive from rest to rest. Raises UnfitDriveError, or KeyboardInterrupt after an interrupted motion's end."""
        self._connection.dispatch(self)  # what came while a person thought: another's drive may be in it
        self.wheels.clear()
        wish = Wish((Move(distance=DISTANCE), Move(distance=-DISTANCE)), speed=SPEED)
        connection = self._connection
        with (
            StopSignal() as stopping,
            closing(MotionClient(connection.session, connection.robot, self._by, wish)) as it,
        ):
            self._client = it
            result = self._follow(it, stopping)
            self._client = None
        if stopping.asked:
            raise KeyboardInterrupt
        if not result.arrived:
            reason = result.reason or result.outcome
            raise UnfitDriveError(
                f"the drive stopped before its end: {reason}" if result.begun else f"the robot has not moved: {reason}"
            )
        if time.monotonic() - self._heard_at > _SILENCE:
            raise UnfitDriveError("the wheels fell silent; check base, and the network to it")
        if self._slowed:
            raise UnfitDriveError(f"guard has slowed the robot: {self._slowed}")
        granted = self._granted
        if granted is None or not self._wait(
            lambda: self._lease is not None and self._lease.counter != granted.counter
        ):
            raise UnfitDriveError("nobody tells that giraff_motion has given the robot back; see giraff why")

    def on_sample(self, topic: Topic[Any], key: str, sample: Sample, at_ns: int) -> None:
        """As a `Listener`."""
        del topic, key, at_ns
        state = self._client.state if self._client is not None else None
        if isinstance(sample, Wheels):
            self.wheels.append(sample)
            self._heard_at = time.monotonic()
        elif isinstance(sample, Battery):
            self.voltage = sample.voltage
        elif isinstance(sample, Lease):
            self._lease = sample
            if state is not None and state.stage == "moving":
                self._granted = sample
        elif isinstance(sample, GuardedCommand) and state is not None and state.stage == "moving":
            self._slowed = self._slowed or str(sample.reason)

    def on_liveliness(self, service: str, instance: str, *, present: bool) -> None:
        """Motion tells of services that are gone."""

    def _follow(self, client: MotionClient, stopping: StopSignal) -> MotionResult:
        began, self._granted = time.monotonic(), None
        while (result := client.turn(now := time.monotonic())) is None:
            self._connection.dispatch(self)
            if stopping.asked:
                client.cancel(now)
            elif not client.has_asked and now - began > PATIENCE:
                raise UnfitDriveError("the robot has not moved: its clock is not heard; check that giraff_base runs")
            stopping.wait(TURN, patience=stopping.asked + 1)
        self._connection.dispatch(self)
        return result

    def _wait(self, is_so: Callable[[], bool]) -> bool:
        deadline = time.monotonic() + PATIENCE
        while not is_so() and time.monotonic() < deadline:
            self._connection.dispatch(self)
            time.sleep(TURN)
        return is_so()
