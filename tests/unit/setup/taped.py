"""A drawn robot on a floor, and its driver with a tape."""

import math
import random
from typing import Final

from giraff_core.kinematics.calibration import Scales
from giraff_schemas.messages import Wheels
from giraff_setup.wheels.odometry.plan import POSITION_SD, YAW_SD
from giraff_sim.truth import Truth, TruthRanges, draw_truth
from giraff_sim.world.room import Pose
from tests.support.floor_robot import FloorRobot
from tests.unit.setup import person

_SPEED: Final = 0.6  # m/s
_RESTS: Final = 0.6  # s


class TapedRobot:
    """Does each leg about right; is measured as well as a tape can."""

    silence = 0.0

    def __init__(self, seed: int) -> None:
        self.truth: Truth = draw_truth("uncalibrated", TruthRanges(), seed)
        self.robot = FloorRobot(self.truth, seed)
        self._chance = random.Random(f"{seed}/tape")
        self._start = self.robot.pose
        self._told = 0
        self.robot.stand(_RESTS)

    @property
    def true_scales(self) -> Scales:
        """A turn is what the wheels make of it less what is slipped: as if the track were so much wider."""
        truth = self.truth
        return Scales(truth.left.scale, truth.right.scale, truth.track_scale / (1.0 - truth.turn_slip))

    def poll(self) -> list[Wheels]:
        heard = self.robot.heard[self._told :]
        self._told += len(heard)
        return heard

    def drive(self, leg: str) -> None:
        self._start = self.robot.pose
        kind, _, side = leg.partition(" ")
        sign = -1.0 if side == "right" else 1.0
        if kind == "line":
            self.robot.go(5.0, _SPEED)
        elif kind == "turns":
            self.robot.turn(sign * 3.0 * math.tau, _SPEED)
        else:
            for _ in range(4):
                self.robot.go(2.0, _SPEED)
                self.robot.turn(sign * math.tau / 4.0, _SPEED)
        self.robot.stand(_RESTS)

    def measure(self) -> person.Pose:
        """Marks and end are each off by what the tape is good for."""
        start, end = self._marked(self._start), self._marked(self.robot.pose)
        cos, sin = math.cos(start.yaw), math.sin(start.yaw)
        x, y = end.x - start.x, end.y - start.y
        heading = math.degrees(math.remainder(end.yaw - start.yaw, math.tau))
        return person.Pose(cos * x + sin * y, cos * y - sin * x, heading)

    def _marked(self, pose: Pose) -> Pose:
        chance = self._chance
        return Pose(
            chance.gauss(pose.x, POSITION_SD), chance.gauss(pose.y, POSITION_SD), chance.gauss(pose.yaw, YAW_SD)
        )
