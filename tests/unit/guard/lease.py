"""A guard's authority and those who speak to it."""

import math

from giraff_core.live import Live
from giraff_guard.config import GuardConfig
from giraff_guard.lease_holder import LeaseHolder
from giraff_schemas.messages import DriveCommand, RobotTime, Source
from giraff_schemas.trouble import Trouble

EPOCH = 7
FIRST = 1000
CONFIG = GuardConfig(priorities={"carer": 2, "child": -1})
PERIOD = 0.05  # s between two commands


class Room:
    """A guard's authority and those who speak to it, in robot time."""

    def __init__(self, first_lease: int = FIRST) -> None:
        self.authority = LeaseHolder(Live(CONFIG), first_lease)
        self.robot_ns = 10**12
        self._seq = 0

    @property
    def now(self) -> RobotTime:
        return RobotTime(epoch=EPOCH, robot_ns=self.robot_ns)

    def wait(self, seconds: float) -> None:
        self.robot_ns += round(seconds * 1e9)

    def ago(self, seconds: float, epoch: int = EPOCH) -> RobotTime:
        return RobotTime(epoch=epoch, robot_ns=self.robot_ns - round(seconds * 1e9))

    def say(
        self,
        instance: str,
        counter: int,
        linear: float = 0.0,
        *,
        name: str = "joystick",
        source: Source = "hand",
        age: float = 0.0,
        seq: int | None = None,
        epoch: int = EPOCH,
    ) -> DriveCommand:
        self._seq += 1
        command = DriveCommand(
            seq=self._seq if seq is None else seq,
            instance=instance,
            operator=name,
            lease_counter=counter,
            linear_x=linear,
            angular_z=0.0,
            source=source,
            reason=Trouble("the hand is lost" if source == "fault" else ""),
            tick=self.ago(age, epoch) if math.isfinite(age) else None,
        )
        self.authority.on_command(command, self.now)
        return command

    def drive(self, instance: str, seconds: float, linear: float = 0.0, source: Source = "hand") -> None:
        """Commands at a steady pace under the lease in force when it begins."""
        counter = self.authority.counter
        for _ in range(round(seconds / PERIOD)):
            self.wait(PERIOD)
            self.say(instance, counter, linear, source=source)

    @property
    def holder(self) -> str:
        self.authority.review(self.now)
        return self.authority.holder

    @property
    def passes(self) -> float | None:
        """What the command that counts now asks for."""
        self.authority.review(self.now)
        command, refusal = self.authority.asked(self.now)
        assert (command is None) is bool(refusal)
        return command.linear_x if command is not None else None
