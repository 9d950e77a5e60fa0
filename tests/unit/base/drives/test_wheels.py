"""The contract of two wheels: by levels, by speeds that the board holds, and those of the robot files."""

from giraff_schemas.wire import COMMAND_TIMEOUT_MS, Latch
from tests.support.robot_files import ROBOTS, FileRobot
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


class FileBoard(WheelsBoard):
    """The board of a robot file, with its motors."""

    def __init__(self, file: FileRobot) -> None:
        self.robot, self.time_constant = file.settings.robot, file.sim.motor_time_constant
        super().__init__(robot=self.robot, max_level=file.drive.max_level)


class TestArdros(TestByLevels):
    file = ROBOTS["ardros"]
    config = file.drive
    robot = file.settings.robot

    def board(self) -> FileBoard:
        return FileBoard(self.file)


class TestMegaL298n(TestArdros):
    file = ROBOTS["mega_l298n"]
    config = file.drive
    robot = file.settings.robot


class TestMegaBts7960(TestArdros):
    file = ROBOTS["mega_bts7960"]
    config = file.drive
    robot = file.settings.robot
