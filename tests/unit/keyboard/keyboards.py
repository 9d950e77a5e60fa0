"""The robot, the settings and the clocks of these tests."""

from giraff_keyboard.config import KeyboardConfig
from giraff_keyboard.policy import Key, KeyboardPolicy
from giraff_schemas.messages import DriveCommand, Lease, RobotTime, Tick
from giraff_schemas.trouble import Trouble
from tests.support.operators import said
from tests.support.robots import ROBOT

EPOCH = 77
CONFIG = KeyboardConfig(steps=5, first_step=5)
"""Full speed, so that the figures are the robot's."""


class Person:
    """A keyboard's policy, its two clocks and the fingers on it."""

    def __init__(self, config: KeyboardConfig = CONFIG) -> None:
        self.policy = KeyboardPolicy(config, ROBOT, "me")
        self.now = 100.0
        self.robot_ns = 5_000_000_000

    def tick(self) -> None:
        self.policy.operator.on_tick(Tick(epoch=EPOCH, robot_ns=self.robot_ns), self.now)

    def wait(self, seconds: float, *, ticks: bool = True) -> list[DriveCommand]:
        """Let time pass in steps of 20 ms; the command of each."""
        commands = []
        for _ in range(round(seconds / 0.02)):
            self.now += 0.02
            self.robot_ns += 20_000_000
            if ticks:
                self.tick()
            commands.append(said(self.policy, self.now))
        return commands

    def press(self, key: Key) -> DriveCommand:
        self.policy.on_key(key, self.now)
        return said(self.policy, self.now)

    def hear(self, holder: str, counter: int, seq: int = 1, reason: str = "held") -> None:
        lease = Lease(
            seq=seq, instance="guard", holder=holder, operator=holder, counter=counter, reason=Trouble(reason)
        )
        self.policy.operator.on_lease(lease)

    @property
    def tick_now(self) -> RobotTime:
        return RobotTime(epoch=EPOCH, robot_ns=self.robot_ns)


def person(config: KeyboardConfig = CONFIG) -> Person:
    """One who has heard the robot."""
    someone = Person(config)
    someone.wait(0.1)
    return someone
