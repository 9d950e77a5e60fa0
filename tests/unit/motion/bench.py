"""The policy of giraff_motion around a robot on an open floor, with all that it hears of the others."""

from typing import Any, Final, TypeVar

import msgspec

from giraff_core.kinematics.calibration import Calibration
from giraff_core.kinematics.pose import Pose
from giraff_core.live import Live
from giraff_core.robot import RobotConfig
from giraff_motion.config import MotionConfig
from giraff_motion.policy import MotionPolicy
from giraff_odometry.config import OdometryConfig
from giraff_odometry.policy import OdometryPolicy
from giraff_schemas.codec import stamped
from giraff_schemas.localization import LocalizationState
from giraff_schemas.messages import (
    BaseState,
    BoardState,
    DirectionLimit,
    DriveCommand,
    EStop,
    GuardState,
    Lease,
    RobotTime,
    Sample,
    Tick,
)
from giraff_schemas.motion import MotionAnswer, MotionCancel, MotionHold, MotionRequest, MotionState
from giraff_schemas.trouble import Trouble
from giraff_sim.truth import Truth
from tests.support.floor_robot import FloorRobot
from tests.support.map_poses import map_pose
from tests.support.robots import ROBOT

PERIOD: Final = 0.02
"""s"""
REQUESTER: Final = "asker-1"
POSE_PERIODS: Final = 5
"""The same of localization: ten."""
HOLD_PERIODS: Final = 2
"""From one word of the requester to the next: 25 in a second."""
ARMS: Final = 10
"""Neutral commands in a row, which arm."""
FREE: Final = DirectionLimit(allowed=1.0, clearance="free", sensor="")
BLOCKED: Final = DirectionLimit(
    allowed=0.0, clearance="blocked", sensor="front_left", reason=Trouble("wall at 0.20 m", "back away")
)
_BOARD: Final = BoardState(
    connected=True, boot_id=1, drive_state="", latch="", last_refusal="", accepted=0, refused=0, line_errors=0
)

SampleT = TypeVar("SampleT", bound=Sample)
RequestT = TypeVar("RequestT", bound=MotionRequest)


class Bench:
    """Step it; break what is to be broken between two steps."""

    def __init__(
        self,
        truth: Truth | None = None,
        seed: int = 1,
        calibration: Calibration | None = None,
        config: MotionConfig | None = None,
        step: float = 0.004,
    ) -> None:
        self.robot: RobotConfig = msgspec.structs.replace(ROBOT, calibration=calibration or Calibration())
        self.floor = FloorRobot(truth or Truth(), seed, self.robot, step)
        self.odometry = OdometryPolicy(Live(OdometryConfig()), self.robot)
        self.policy = MotionPolicy(Live(config or MotionConfig()), self.robot, "motion-1")
        self.now = 100.0
        self.epoch = 7
        self.asked = 0
        """Id of the newest request."""
        self.holder = ""
        """Instance that has the lease, and its name is the same."""
        self.requester_is_there = True
        self.odometry_is_there = True
        self.localization: LocalizationState | None = None
        """What localization says; None: it is not there."""
        self.localizer = "localization-1"
        """Its process."""
        self.odom_in_map = Pose(0.0, 0.0, 0.0)
        self.map_tick: RobotTime | None = None
        """In what localization says; None: the newest."""
        self.guard_is_there = True
        self.base_is_there = True
        self.lease_is_told = True
        self.base_arms = True
        self.stopped = False
        """The emergency stop is engaged."""
        self.board_is_there = True
        self.disarmed = ""
        """Why base does not drive; empty: nothing is against it."""
        self.slowed = ""
        """Base's reason while it is armed."""
        self.stiction = 0.0
        """m/s; a speed that is asked for, and is less, moves nothing."""
        self.pushed = 0.0
        """m/s at which somebody pushes it while no motor drives it ahead."""
        self.ways: dict[str, Any] = dict.fromkeys(("forward", "backward", "turn_left", "turn_right"), FREE)
        self.held: list[RobotTime] = []
        """What the requester has sent."""
        self.hold_delay = 0.0
        """s from the requester's tick to the arrival of its hold."""
        self.said: list[DriveCommand] = []
        """All commands."""
        self.odometry_pose = Pose(0.0, 0.0, 0.0)
        self._seq = 0
        self._level = 0
        self._heard = 0
        self._drives = (0.0, 0.0)
        self.run(0.2)

    @property
    def tick(self) -> RobotTime:
        """The robot's clock."""
        return RobotTime(epoch=self.epoch, robot_ns=round(self.now * 1e9))

    def state(self) -> MotionState:
        """What it says now."""
        return self.policy.state(self.now)

    @property
    def armed(self) -> bool:
        return self._level >= ARMS and self.board_is_there and not (self.disarmed or self.stopped)

    def wish(self, kind: type[RequestT], **values: Any) -> RequestT:
        """A request of this moment."""
        self.asked += 1
        said: dict[str, Any] = {"by": "somebody", "id": self.asked, "instance": REQUESTER, "tick": self.tick}
        return kind(**said | values)

    def ask(self, kind: type[MotionRequest], **values: Any) -> MotionAnswer:
        return self.policy.on_request(self.wish(kind, **values), self.now)

    def refused(self, kind: type[MotionRequest], **values: Any) -> str:
        """Ask, and hear why not."""
        answer = self.ask(kind, **values)
        assert not answer.accepted
        return str(answer.reason)

    def begin(self, kind: type[MotionRequest], **values: Any) -> None:
        """Ask, and have it move."""
        answer = self.ask(kind, **values)
        assert answer.accepted, answer.reason
        while self.state().stage == "arming":
            self.step()

    def finish(self, within: float = 120.0) -> MotionState:
        """Until it has ended."""
        until = self.now + within
        while self.state().stage != "ended":
            assert self.now < until, self.state()
            self.step()
        return self.state()

    def do(self, kind: type[MotionRequest], **values: Any) -> MotionState:
        """From request to end."""
        answer = self.ask(kind, **values)
        assert answer.accepted, answer.reason
        return self.finish()

    def cancel(self, wish: int = 0) -> MotionAnswer:
        return self.policy.on_cancel(MotionCancel(by="somebody", id=wish), self.now)

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds / PERIOD)):
            self.step()

    def step(self) -> None:
        """One period: what drives now was asked for in the one before."""
        linear, angular = self._drives
        self.floor.drive(linear or self.pushed, angular, PERIOD)
        self.now += PERIOD
        self._seq += 1
        self._tell()
        asked = self.policy.poll(self.now)
        command = None if asked is None else self.policy.operator.say(asked)
        self._obey(command)
        if command is not None:
            self.said.append(command)

    def _tell(self) -> None:
        policy, now = self.policy, self.now
        policy.operator.on_tick(self._said(Tick(epoch=self.epoch, robot_ns=self.tick.robot_ns), "base-1"), now)
        reason = "" if self.holder else "nobody drives"
        lease = Lease(holder=self.holder, operator=self.holder.partition("-")[0], counter=1, reason=Trouble(reason))
        if self.lease_is_told:
            policy.on_lease(self._said(lease, "guard-1"), now)
        if self.requester_is_there and self.asked and self._seq % HOLD_PERIODS == 0:
            self.held.append(RobotTime(epoch=self.epoch, robot_ns=round((now - self.hold_delay) * 1e9)))
            policy.on_hold(self._said(MotionHold(id=self.asked, tick=self.held[-1]), REQUESTER))
        if self.guard_is_there:
            state = GuardState(**self.ways, operator=self.holder, sensors={})
            policy.on_guard(self._said(state, "guard-1"), now)
        if self.base_is_there:
            policy.on_base(self._said(self._base(), "base-1"), now)
        stop = EStop(engaged=self.stopped, id=1, by="a cat", reason=Trouble("tail under a wheel"))
        policy.on_estop(self._said(stop, "base-1"))
        for wheels in self.floor.heard[self._heard :]:
            sample = self.odometry.on_wheels(msgspec.structs.replace(wheels, tick=self.tick))
            if sample is not None and self.odometry_is_there:
                policy.on_odometry(self._said(sample, "odometry-1"), now)
                self.odometry_pose = Pose(sample.x, sample.y, sample.yaw)
        self._heard = len(self.floor.heard)
        if self.localization is not None and self._seq % POSE_PERIODS == 0:
            robot = self.odometry_pose
            pose = map_pose(self.odom_in_map, robot, self.map_tick or self.tick, self.localization)
            policy.on_pose(self._said(pose, self.localizer), now)

    def _base(self) -> BaseState:
        return BaseState(
            armed=self.armed,
            driving=False,
            reason=Trouble(self.disarmed or (self.slowed if self.armed else "hold level to arm")),
            guard="guard-1",
            round_trip=None,
            budget_left=None,
            board=msgspec.structs.replace(_BOARD, connected=self.board_is_there),
        )

    def _obey(self, command: DriveCommand | None) -> None:
        """As guard and base do, without their speed limits."""
        if command is not None and command.lease_counter == 0 and not self.holder:
            self.holder = "motion-1"
        if command is None or self.holder != "motion-1":
            self._level, self._drives = 0, (0.0, 0.0)
            return
        if command.source == "fault" or not self.base_arms:
            self._level = 0
        elif command.neutral or self.armed:
            self._level += 1
        is_enough = abs(command.linear_x) >= self.stiction
        self._drives = (command.linear_x, command.angular_z) if self.armed and is_enough else (0.0, 0.0)

    def _said(self, sample: SampleT, instance: str) -> SampleT:
        return stamped(sample, self._seq, 0, instance)
