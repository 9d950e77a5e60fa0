"""A robot before a simulated wall, moved by what its wheels truly do, and the person who measures there with a tape."""

import math
from collections.abc import Callable, Mapping, Sequence
from random import Random
from typing import Final, Protocol

from giraff_core.kinematics.pose import Pose
from giraff_core.motion.result import MotionResult
from giraff_core.robot import RobotConfig
from giraff_core.senses import Ultrasonic
from giraff_schemas.motion import Move, Step, Turn
from giraff_schemas.wire import ECHO_US_PER_M
from giraff_setup.ultrasonic.fit import Echo
from giraff_setup.ultrasonic.procedure import TURN_SPEED, StoppedError
from giraff_sim.config import SimConfig
from giraff_sim.truth import Level, TruthRanges, draw_truth
from giraff_sim.world import room as sim
from giraff_sim.world.sonar import NO_ECHO_US, sonars

RANGES: Final = TruthRanges(sensor_x=0.03, sonar_scale=0.04, sensor_yaw=math.radians(6.0), sonar_noise=0.01)
_CYCLE: Final = 0.18  # s between two pings of a sensor
_LATE: Final = 0.01  # s by which odometry's pose of a ping is late
_TAPE: Final = 0.003  # m, standard deviation
_WAY_SD: Final[dict[Level, float]] = {"exact": 0.001, "calibrated": 0.002, "uncalibrated": 0.012 / math.sqrt(2.0)}


def bare_wall(distance: float, half: float = 5.0) -> sim.Room:
    room = sim.Room("wall", sim.Pose(0.0, 0.0, 0.0))
    room.add_wall("wall", [(distance, -half), (distance, half)])
    return room


class DrawnStand:
    """As `Stand`: pings of the simulator's sensors at the poses of the procedure, without simulated time."""

    def __init__(
        self,
        robot: RobotConfig,
        seed: int,
        level: Level = "calibrated",
        room: sim.Room | None = None,
        askew: float = 0.0,
    ) -> None:
        """`askew`: rad by which the robot stands turned to the left of square."""
        self.truth = draw_truth(level, RANGES, seed)
        self.distance = 0.9
        self.true = sim.Pose(0.0, 0.0, askew)
        self.refusal = ""
        self.holds_lease = False
        self.interrupts = False
        self.is_driven = False
        """Somebody moves it while it listens."""
        self.performed: list[Step] = []
        self._robot, self._way_sd = robot, _WAY_SD[level]
        self._odometry = Pose(3.0, -2.0, 1.0)
        self._sensors = robot.of(Ultrasonic)
        self.sonars = sonars(self._sensors, room or bare_wall(self.distance), SimConfig(), seed, self.truth)

    def place(self) -> Pose:
        return self._odometry

    def listen(self, sensors: Sequence[str], pings: int) -> list[Echo]:
        heard = [self._ping(name, self._odometry) for _ in range(pings) for name in sensors]
        if self.is_driven:
            self._odometry = Pose(self._odometry.x - 0.02, self._odometry.y, self._odometry.yaw)
        return heard

    def perform(self, steps: Sequence[Step]) -> tuple[MotionResult, list[Echo]]:
        if self.interrupts:
            raise KeyboardInterrupt
        if self.refusal:
            raise StoppedError(self.refusal)
        echoes, sd = list[Echo](), 0.0
        for step in steps:
            self.performed.append(step)
            if isinstance(step, Turn):
                count = round(abs(step.angle) / TURN_SPEED / _CYCLE)
                for _ in range(count):
                    before = self._roll(0.0, step.angle / count)
                    late = before.yaw + (self._odometry.yaw - before.yaw) * (1.0 - _LATE / _CYCLE)
                    echoes += [self._ping(name, self._odometry._replace(yaw=late)) for name in self._sensors]
            elif isinstance(step, Move):
                for _ in range(20):
                    self._roll(step.distance / 20.0, 0.0)
                sd = abs(step.distance) * self._way_sd
        return MotionResult(outcome="arrived", begun=True, standard_deviations=(sd, sd, sd)), echoes

    def idle(self) -> str:
        return ""

    def wait_released(self) -> None:
        if self.holds_lease:
            raise StoppedError("giraff_motion still holds the lease")

    def taped(self, side: str) -> float:
        half = self._robot.track_width * self.truth.track_scale / 2.0 * (1.0 if side == "left" else -1.0)
        return self.distance - (self.true.x - math.sin(self.true.yaw) * half)

    def _ping(self, name: str, odometry: Pose) -> Echo:
        echo_us = self.sonars[self._sensors[name].index].echo_us(self.true)
        return Echo(name, None if echo_us >= NO_ECHO_US else echo_us / ECHO_US_PER_M, odometry)

    def _roll(self, distance: float, turn: float) -> Pose:
        """Move both by what odometry takes for so much; return its pose before."""
        half = self._robot.track_width / 2.0
        left, right = distance - turn * half, distance + turn * half
        left, right = left * self.truth.left.scale, right * self.truth.right.scale
        turned = (right - left) / (2.0 * half * self.truth.track_scale) * (1.0 - self.truth.turn_slip)
        before, self._odometry = self._odometry, self._odometry.moved(distance, turn)
        self.true = sim.Pose(*Pose(*self.true).moved((left + right) / 2.0, turned))
        return before


Answer = str | type[BaseException]


class Taped(Protocol):
    """What a person can measure."""

    def taped(self, side: str) -> float:
        """Return m from the wall to where the left or the right wheel truly touches the floor."""
        ...


class TapePerson:
    """Types what a tape gives, keeps y and z, and says yes.

    `instead` has other answers, by words in a question; each is given once.
    """

    def __init__(self, stand: Taped, seed: int = 0, instead: Mapping[str, Sequence[Answer]] | None = None) -> None:
        self._stand, self._chance = stand, Random(seed)
        self.instead = {words: list(answers) for words, answers in (instead or {}).items()}
        self.told: list[str] = []
        self.asked: list[str] = []

    def show(self, text: str) -> None:
        self.told.append(text)

    def ask(self, question: str, meanwhile: Callable[[], str]) -> str:
        meanwhile()
        self.asked.append(question)
        assert len(self.asked) < 60, self.told[-3:]
        for words, answers in self.instead.items():
            if words in question and answers:
                answer = answers.pop(0)
                if isinstance(answer, str):
                    return answer
                raise answer()
        for side in ("left", "right"):
            if f"{side} wheel" in question:
                return f"{self._stand.taped(side) + self._chance.gauss(0.0, _TAPE):.4f}"
        return "" if "ENTER" in question else "yes"
