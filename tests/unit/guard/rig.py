"""The guard's policy with hands, sensors and wheels, in simulated robot time: the rig of these tests."""

import msgspec

from giraff_core.lease import ASK
from giraff_core.live import Live
from giraff_core.robot import RobotConfig
from giraff_guard.config import GuardConfig
from giraff_guard.lease_holder import LeaseHolder
from giraff_guard.policy import GuardPolicy
from giraff_schemas.messages import (
    DriveCommand,
    GuardedCommand,
    GuardState,
    Lease,
    Range,
    RobotTime,
    Source,
    Tick,
    Wheels,
)
from giraff_schemas.trouble import Trouble
from tests.support import robots

FRONT = ("front_left", "front_right")
ROBOT = msgspec.structs.replace(robots.ROBOT, ticks_per_metre=2000.0)
CONFIG = GuardConfig(deceleration=1.5)
EPOCH = 7
FIRST_LEASE = 41
OPERATOR = "operator-1"
FAR, NEAR = 3.0, 0.3  # m: free, and well inside the margin


def robot_with(*sensors: str) -> RobotConfig:
    """The robot with these of its sensors only."""
    return msgspec.structs.replace(ROBOT, sensors={name: ROBOT.sensors[name] for name in sensors})


class Rig:
    """A guard that has heard base; `decide` is what it does now."""

    def __init__(self, robot: RobotConfig = ROBOT, config: GuardConfig = CONFIG, ticking: bool = True) -> None:
        self.robot = robot
        self.live = Live(config)
        self.guard = GuardPolicy(self.live, robot, first_lease=FIRST_LEASE)
        self.lease: Lease | None = None
        """As of the newest `decide`."""
        self.robot_ns = 1_000_000_000_000
        self.hurries = False
        """Whether the newest command, or a reading of the newest ones, cannot wait for the next decision."""
        self._seq = 0
        self._ticking = ticking
        if ticking:
            self.tick()

    def ago(self, seconds: float, epoch: int = EPOCH) -> RobotTime:
        return RobotTime(epoch=epoch, robot_ns=self.robot_ns - round(seconds * 1e9))

    def wait(self, seconds: float) -> None:
        """Let time pass; base ticks at its end, if it does at all."""
        self.robot_ns += round(seconds * 1e9)
        if self._ticking:
            self.tick()

    def pause(self, seconds: float) -> None:
        """Let time pass without a word of base."""
        self.robot_ns += round(seconds * 1e9)

    def tick(self, epoch: int = EPOCH) -> None:
        """Of the base that runs in this epoch."""
        self._seq += 1
        tick = Tick(seq=self._seq, instance=f"base-{epoch}", epoch=epoch, robot_ns=self.robot_ns)
        self.guard.on_tick(tick, self.robot_ns)

    def hear(
        self,
        distance: float | None = FAR,
        sensor: str = "",
        age: float = 0.05,
        fault: str = "",
        tick: RobotTime | None = None,
        seq: int | None = None,
        ranger: str = "ranger-1",
    ) -> None:
        """A reading of one sensor, or of all; None: nothing within reach."""
        self._seq += 1
        self.hurries = False
        for name in [sensor] if sensor else self.robot.sensors:
            measured = None if fault else distance
            self.hurries |= self.guard.on_sensed(
                Range(
                    seq=self._seq if seq is None else seq,
                    instance=ranger,
                    sensor=name,
                    state="fault" if fault else "clear" if measured is None else "echo",
                    range=measured,
                    echo_us=round((measured or 0.0) * 5800),
                    reason=Trouble(fault),
                    tick=self.ago(age) if tick is None else tick,
                ),
                self.robot_ns,
            )

    def look(self, distance: float | None = FAR, ranger: str = "ranger-1") -> None:
        """Stand still and hear all sensors, until what they tell is believed."""
        for _ in range(20):
            self.wait(0.18)
            self.move(0.0)
            self.hear(distance, age=0.0, ranger=ranger)
            self.decide()

    def ask(
        self,
        linear: float,
        angular: float = 0.0,
        *,
        age: float = 0.03,
        operator: str = OPERATOR,
        source: Source = "hand",
        reason: str = "",
        tick: RobotTime | None = None,
        seq: int | None = None,
        counter: int | None = None,
        name: str = "joystick",
    ) -> DriveCommand:
        """A command of an operator, who asks for a free lease first and then speaks under the one in force."""
        if counter is None:
            if not self._leased().holder and self._ticking:
                self.ask(0.0, operator=operator, counter=ASK, age=0.0, seq=0 if seq is not None else None, name=name)
            counter = self._leased().counter
        self._seq += 1
        command = DriveCommand(
            seq=self._seq if seq is None else seq,
            instance=operator,
            operator=name,
            lease_counter=counter,
            linear_x=linear,
            angular_z=angular,
            source=source,
            reason=Trouble(reason),
            tick=self.ago(age) if tick is None else tick,
        )
        self.hurries = self.guard.on_command(command, self.robot_ns)
        return command

    def move(self, velocity: float, age: float = 0.0, turning: float = 0.0, base: int = EPOCH) -> None:
        """The wheels' newest report, of the base of this number."""
        self._seq += 1
        self.guard.on_wheels(
            Wheels(
                seq=self._seq,
                instance=f"base-{base}",
                left_ticks=0,
                right_ticks=0,
                left_velocity=velocity - turning,
                right_velocity=velocity + turning,
                left_pwm_counts=0,
                right_pwm_counts=0,
                board_us=0,
                boot_id=1,
                tick=self.ago(age),
            ),
            self.robot_ns,
        )

    def decide(self) -> tuple[GuardedCommand, GuardState]:
        command, self.lease = self.guard.decide(self.robot_ns), self.guard.lease()
        return command, self.guard.state()

    def passes(self, linear: float, angular: float = 0.0) -> tuple[float, float]:
        """What comes out of asking for this now."""
        self.ask(linear, angular)
        command, _ = self.decide()
        return command.linear_x, command.angular_z

    def _leased(self) -> LeaseHolder:
        authority = self.guard._lease_holder
        authority.review(self.guard._identity.now(self.robot_ns))
        return authority
