"""The contract of two wheels: by levels, by speeds that the board holds, and those of Ardros."""

from giraff_schemas.wire import COMMAND_TIMEOUT_MS, Latch
from tests.support.ardros import ARDROS, SIM
from tests.support.ardros import DRIVE as ARDROS_DRIVE
from tests.support.robots import BY_SPEED, DRIVE, ROBOT
from tests.unit.base.drives.contract import AnyDrive
from tests.unit.base.rig import STEP_NS, Board


class WheelsBoard(Board):
    period_ns = STEP_NS
    robot = ROBOT

    def twist(self) -> tuple[float, float]:
        return self.robot.kinematics.twist(*self.speeds)

    def is_safe(self) -> bool:
        return self.levels == (0, 0)

    def is_latched(self) -> bool:
        return self.latch != Latch.NONE

    def is_off(self) -> bool:
        return self.is_safe()

    def latch_by_itself(self) -> None:
        self.engage(Latch.LEFT_STUCK)


class TestByLevels(AnyDrive):
    config = DRIVE
    command_timeout = COMMAND_TIMEOUT_MS / 1000

    def board(self) -> WheelsBoard:
        return WheelsBoard()


class TestBySpeeds(TestByLevels):
    config = BY_SPEED


class ArdrosBoard(WheelsBoard):
    robot = ARDROS.robot
    time_constant = SIM.motor_time_constant

    def __init__(self) -> None:
        super().__init__(robot=self.robot, max_level=ARDROS_DRIVE.max_level)


class TestArdros(TestByLevels):
    config = ARDROS_DRIVE
    robot = ARDROS.robot

    def board(self) -> ArdrosBoard:
        return ArdrosBoard()
