"""The encoders of a simulated robot read the drawing of a disk: counted by the firmware at its pins."""

import math
from pathlib import Path
from typing import NamedTuple

import pytest

from giraff_base.config import DriveConfig
from giraff_core.encoder_disk import Disk, drawing
from giraff_core.robot import RobotConfig
from giraff_schemas.framing import Decoder
from giraff_schemas.wire import BoardKind, WheelsFrame
from giraff_schemas.wires.balancer import BalanceFrame
from giraff_sim.board import Implementation
from giraff_sim.bodies.registry import mirrored, world_of
from giraff_sim.config import SimConfig
from giraff_sim.simulation import simulation
from giraff_sim.world.hand import StillHand
from tests.sim.robots import empty_room
from tests.support import balancer_file
from tests.support.robots import DRIVE, ROBOT


class Robot(NamedTuple):
    config: RobotConfig
    drive: DriveConfig


WHEELS = Robot(ROBOT, DRIVE)
BALANCER = Robot(balancer_file.ROBOT, balancer_file.DRIVE)


def without_a_sector(text: str) -> str:
    """Delete a black sector of the outer ring from a drawing."""
    lines = text.splitlines(keepends=True)
    assert lines[7].endswith('Z" fill="#000"/>\n')
    return "".join(lines[:7] + lines[8:])


def counted(
    robot: Robot, implementation: Implementation, file: Path, turns: tuple[int, int], *, cut: bool = False
) -> tuple[float, float]:
    """Return what the board counts of both encoders while their disks turn so often.

    cut: its wires are cut in the middle third.
    """
    sim = SimConfig(encoder_disk=str(file))
    world = world_of(empty_room(), robot.config, robot.drive, sim, StillHand(), seed=1)
    with simulation(world, (BoardKind.BASE,), implementation) as running:
        board = running.boards[BoardKind.BASE]
        decoder, frames = Decoder(board.type.frames), []
        for ms in range(1, 401):
            for motor, number in zip(board.model.motor, turns, strict=True):
                motor.encoder_cut = int(cut and 150 < ms <= 250)
                motor.position = 160 * number * min(max(0, ms - 50), 300) / 300
            board.run(ms * 1000)
            frames += decoder.feed(board.read())
    first, last = (
        counts_of([each for each in frames if isinstance(each, WheelsFrame | BalanceFrame)], i) for i in (0, -1)
    )
    return last[0] - first[0], last[1] - first[1]


def counts_of(frames: list[WheelsFrame | BalanceFrame], number: int) -> tuple[float, float]:
    frame = frames[number]
    if isinstance(frame, WheelsFrame):
        return frame.left_ticks, frame.right_ticks
    lean = frame.lean_urad / 1e6 * 5120 / math.tau
    return frame.left_counts - lean, frame.right_counts - lean


@pytest.mark.parametrize(
    ("robot", "a_turn", "off"), [(WHEELS, 80, 0.0), (BALANCER, 160, 1.1)], ids=["base", "balancer"]
)
@pytest.mark.parametrize("implementation", [*Implementation], ids=str)
def test_a_printed_disk_is_counted_both_ways(
    robot: Robot, a_turn: int, off: float, implementation: Implementation, tmp_path: Path
) -> None:
    file = tmp_path / "disk.svg"
    file.write_text(drawing(Disk()))
    assert counted(robot, implementation, file, (3, -2)) == pytest.approx((3 * a_turn, -2 * a_turn), abs=off)


@pytest.mark.parametrize("implementation", [*Implementation], ids=str)
def test_a_sector_that_is_missing_is_not_counted(implementation: Implementation, tmp_path: Path) -> None:
    file = tmp_path / "disk.svg"
    file.write_text(without_a_sector(drawing(Disk())))
    assert counted(WHEELS, implementation, file, (-1, 3)) == (-78, 3 * 78)


@pytest.mark.parametrize("implementation", [*Implementation], ids=str)
def test_an_encoder_whose_wires_are_mended_counts_on_from_where_its_disk_is(
    implementation: Implementation, tmp_path: Path
) -> None:
    file = tmp_path / "disk.svg"
    file.write_text(without_a_sector(drawing(Disk(offset=1 / 6, black=0.4))))
    assert counted(WHEELS, implementation, file, (3, -3), cut=True) == pytest.approx((2 * 78, -2 * 78), abs=1)


def test_the_encoder_that_a_base_board_has_mirrored_sees_the_disk_turn_the_other_way(tmp_path: Path) -> None:
    file = tmp_path / "disk.svg"
    file.write_text(drawing(Disk(offset=1 / 6)))
    for robot, sees in ((WHEELS, mirrored), (BALANCER, lambda disk: disk)):
        sim = SimConfig(encoder_disk=str(file))
        first, second = world_of(empty_room(), robot.config, robot.drive, sim, StillHand(), seed=1).body.disks
        assert second == sees(first)
