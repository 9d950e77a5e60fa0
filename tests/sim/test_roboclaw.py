"""The contract of two wheels, with the process in front of a motor controller: judged by the controller's record."""

from collections.abc import Iterator
from pathlib import Path
from typing import Final

import msgspec
import pytest

from giraff_schemas.boards import ROBOCLAW_BOARD, ROS_ARDUINO_BRIDGE_BOARD, BoardType
from giraff_schemas.wire import COMMAND_TIMEOUT_MS, Frame, WheelsFrame
from giraff_sim.board import BUILD, Implementation, open_board
from tests.firmware.bench import SpeedBench
from tests.firmware.builds import with_controller
from tests.support.robot_files import ROBOTS
from tests.unit.base.drives.contract import AnyDrive

FILE: Final = ROBOTS["roboclaw"]
STARTS_MS: Final = 120
"""Within which the controller has proved itself and the board reports."""
TAKES_MS: Final = 20
"""Within which a frame has come over the line and a command has gone to the controller."""
ASKED_AGAIN_MS: Final = 200
"""Within which the controller has told of its emergency input again."""
PROCESS_HANGS: Final = 2
SLOW: Final = 0.05
"""m/s."""
BENCHES: Final[list[SpeedBench]] = []


class ProcessBoard:
    period_ns = 10_000_000

    def __init__(self, type_: BoardType = ROBOCLAW_BOARD, build: Path = BUILD) -> None:
        board = open_board(type_, Implementation.HOST, build)
        self.bench = SpeedBench(board, FILE.settings.robot, STARTS_MS)
        BENCHES.append(self.bench)

    def report(self) -> WheelsFrame:
        self.bench.forget()
        for _ in range(STARTS_MS):
            self.bench.run(1)
            if reports := self.bench.all(WheelsFrame):
                return reports[0]
        raise AssertionError("it does not report")

    def receive(self, frame: Frame) -> None:
        self.bench.send(frame)
        self.bench.run(TAKES_MS)

    def reset(self) -> None:
        before = self.bench.model.resets
        self.bench.model.process_stalls = PROCESS_HANGS
        while self.bench.model.resets == before:
            self.bench.run(1)

    def twist(self) -> tuple[float, float]:
        return FILE.settings.robot.kinematics.twist(*self.bench.speed)

    def is_safe(self) -> bool:
        """What drives when it should not drives on; off is a command of the next cycle, and a ramp."""
        self.bench.run(self.bench.board.type.output_delay_us // 1000)
        return self.bench.duties() == (0.0, 0.0)

    def is_latched(self) -> bool:
        return self.report().latch != 0

    def is_off(self) -> bool:
        return self.is_safe()

    def latch_by_itself(self) -> None:
        """Press the controller's emergency input, and let it go."""
        self.bench.model.cord_pulled = 1
        self.bench.run(ASKED_AGAIN_MS)
        assert self.is_latched()
        self.bench.model.cord_pulled = 0
        self.bench.run(ASKED_AGAIN_MS)


@pytest.fixture(autouse=True)
def _close() -> Iterator[None]:
    yield
    while BENCHES:
        BENCHES.pop().board.close()


class TestBySpeeds(AnyDrive):
    config = FILE.drive
    robot = FILE.settings.robot
    command_timeout = COMMAND_TIMEOUT_MS / 1000

    def board(self) -> ProcessBoard:
        return ProcessBoard()

    def test_a_slow_robot_is_not_taken_for_one_that_something_holds(self) -> None:
        bench = self.settled()
        for _ in range(300):
            bench.step(SLOW)
        assert self.robot.max_wheel_speed > bench.board.twist()[0] > SLOW / 2
        assert bench.ask(SLOW).moves
        assert not bench.drive.not_ready


class TestByLevels(TestBySpeeds):
    config = msgspec.structs.replace(FILE.drive, wheel_control="level")


TWIN: Final = ROBOCLAW_BOARD._replace(name="twin", number=99, output_delay_us=30_000)


class TestTwin(TestBySpeeds):
    """An invented controller, after its paper in tests/firmware/twin: what docs/adapter.md calls the next one."""

    def board(self) -> ProcessBoard:
        return ProcessBoard(TWIN, with_controller("twin", "TWIN_BOARD = 99, TWIN_STOPS_AFTER_MS = 200"))


LACKS: Final = (
    "test_a_latch_is_released_by_a_release_alone_and_that_moves_nothing",
    "test_the_boards_own_latch_is_told_with_its_remedy",
    "test_a_lost_board_tells_nothing",
)
"""Of the contract, ros_arduino_bridge has not what these press: an emergency input."""


class TestRosArduinoBridge(TestBySpeeds):
    """Its loop is its own, on the same wheels. It may be faster here than base lets it drive."""

    config = msgspec.structs.replace(
        FILE.drive, board="ros_arduino_bridge", wheel_control="level", battery_volts_per_count=0.0, max_level=160
    )

    def board(self) -> ProcessBoard:
        return ProcessBoard(ROS_ARDUINO_BRIDGE_BOARD)


for _name in LACKS:
    setattr(TestRosArduinoBridge, _name, None)
