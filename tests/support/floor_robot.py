"""A drawn robot on an open floor, its wheels told as base tells them: for what odometry and calibration make of it.

Body, wheels and encoders are the simulator's. What the floor adds at random is drawn here: each wheel slips a little on
each metre. Who pilots it goes by no odometry but by its counts and the robot file, as a person goes by the eye.
"""

import math
import random
from typing import Final

from giraff_core.robot import RobotConfig
from giraff_schemas.messages import RobotTime, Wheels
from giraff_sim.bodies.wheels.plant import Plant, Wheel
from giraff_sim.config import SimConfig
from giraff_sim.truth import Truth
from giraff_sim.world.room import Pose, Room
from tests.support.robots import DRIVE, ROBOT

STEP: Final = 0.01  # s; finer where each command is looked at
REPORT: Final = 0.05  # s, of base
_GAIN: Final = 8.0  # 1/s, by which a wheel's duty follows what it is short of
_REST: Final = 1e-4  # m/s
_SLIPS: Final = (2e-7, 2e-6)
"""m² of variance per metre: from what recorded runs of a small robot in a laboratory leave, to ten times that."""


class FloorRobot:
    """Rests between two calls."""

    def __init__(self, truth: Truth, seed: int, robot: RobotConfig = ROBOT, step: float = STEP) -> None:
        self.robot = robot
        self._seconds = step
        self._chance = random.Random(f"{seed}/floor")
        self._slip = math.exp(self._chance.uniform(*map(math.log, _SLIPS)))
        self._plant = Plant(robot, DRIVE, SimConfig(), Room("floor", Pose(0.0, 0.0, 0.0)), truth)
        self._sides = (_Side(self._plant.left), _Side(self._plant.right))
        self._time = 0.0
        self.heard: list[Wheels] = [self._report()]
        """What base has said so far."""

    @property
    def pose(self) -> Pose:
        """The truth."""
        return self._plant.pose

    def go(self, distance: float, speed: float = 0.5) -> None:
        """Straight on, by its counts; backward where `distance` is negative."""
        way = math.copysign(speed, distance)
        self._drive(way, way, abs(distance))

    def turn(self, angle: float, speed: float = 0.3) -> None:
        """On the spot, by its counts and the file's track. `speed`: m/s of either wheel."""
        way = math.copysign(speed, angle)
        self._drive(-way, way, abs(angle) * self.robot.track_width / 2.0)

    def drive(self, linear_x: float, angular_z: float, seconds: float) -> None:
        """At this speed (m/s, rad/s), as base makes wheels of it."""
        left, right = self.robot.kinematics.wheel_speeds(linear_x, angular_z)
        for _ in range(round(seconds / self._seconds)):
            self._step(left, right)

    def stand(self, seconds: float) -> None:
        """At rest."""
        for _ in range(math.ceil(seconds / self._seconds)):
            self._step(0.0, 0.0)

    def _drive(self, left: float, right: float, travel: float) -> None:
        """Until the wheels have made so many m, on the average, by their counts; then until they rest."""
        start = [side.counted(self.robot) for side in self._sides]
        gone = 0.0
        while gone < travel:
            self._step(left, right)
            gone = sum(
                abs(side.counted(self.robot) - before) for side, before in zip(self._sides, start, strict=True)
            ) / len(self._sides)
        while any(abs(side.wheel.speed) > _REST for side in self._sides):
            self._step(0.0, 0.0)
        self._step(0.0, 0.0, says=True)

    def _step(self, left: float, right: float, *, says: bool = False) -> None:
        for side, aim in zip(self._sides, (left, right), strict=True):
            side.control(aim, self.robot, self._chance, self._slip, self._seconds)
        self._plant.step(self._seconds, self._sides[0].duty, self._sides[1].duty)
        self._time += self._seconds
        if says or self._time - self.heard[-1].board_us * 1e-6 >= REPORT - self._seconds / 2.0:
            self.heard.append(self._report())

    def _report(self) -> Wheels:
        left, right = self._sides
        return Wheels(
            instance="base-1",
            left_ticks=left.ticks,
            right_ticks=right.ticks,
            left_velocity=left.wheel.speed,
            right_velocity=right.wheel.speed,
            left_pwm_counts=round(left.duty),
            right_pwm_counts=round(right.duty),
            board_us=round(self._time * 1e6),
            boot_id=1,
            tick=RobotTime(epoch=1, robot_ns=round(self._time * 1e9)),
        )


class _Side:
    """A wheel with the loop that holds its speed."""

    def __init__(self, wheel: Wheel) -> None:
        self.wheel = wheel
        self.duty = 0.0
        self._extra = 0.0  # counts of turning that the floor did not give, or gave too much
        self._travel = 0.0

    @property
    def ticks(self) -> int:
        """Both edges of channel A."""
        return math.floor(self.wheel.states / 2.0 + self._extra)

    def counted(self, robot: RobotConfig) -> float:
        """m by the counts and the robot file."""
        return self.ticks / robot.ticks_per_metre

    def control(self, aim: float, robot: RobotConfig, chance: random.Random, slip: float, step: float) -> None:
        """One step of so many s towards `aim` m/s."""
        travel, self._travel = abs(self.wheel.travel - self._travel), self.wheel.travel
        self._extra += chance.gauss(0.0, math.sqrt(slip * travel)) * robot.ticks_per_metre
        if aim == 0.0:
            self.duty = 0.0
            return
        per_speed = DRIVE.max_level / robot.max_wheel_speed
        begun = self.duty or aim * per_speed
        self.duty = begun + _GAIN * (aim - self.wheel.speed) * per_speed * step
