"""The same seed gives the same bytes on every UART, in whatever order the boards stand and whoever else is there."""

import hashlib
from collections.abc import Sequence
from functools import cache
from pathlib import Path

from giraff_schemas.wire import BoardKind, ResetCause, TickFrame
from giraff_sim.board import Implementation
from giraff_sim.bodies.registry import world_of
from giraff_sim.config import SimConfig
from giraff_sim.simulation import simulation
from giraff_sim.world.demo_hand import DemoHand
from giraff_sim.world.room import read_room
from giraff_sim.world.sonar import SonarFault
from tests.sim.line import BaseLine, Line
from tests.support.robots import DRIVE, ROBOT

LIVING_ROOM = Path(__file__).parents[2] / "deploy" / "worlds" / "living_room.toml"
ALL = (BoardKind.BASE, BoardKind.JOYSTICK, BoardKind.RANGER)


def drive(base: BaseLine, millisecond: int) -> None:
    """A host that drives a curve that grows tighter."""
    if millisecond == 100:
        base.configure()
    elif millisecond > 200 and millisecond % 20 == 0:
        level = 0 if millisecond < 400 else 40
        base.send(base.drive_frame(level, level - millisecond // 300))


def tick(line: Line, millisecond: int) -> None:
    """A host that sends the robot's time."""
    if millisecond % 25 == 0:
        line.send(TickFrame(seq=millisecond, epoch=3, robot_ns=millisecond * 1_000_000))


def bytes_of(
    implementation: Implementation, kinds: Sequence[BoardKind], seed: int = 1, *, reset: BoardKind | None = None
) -> dict[BoardKind, str]:
    """SHA-256 of what each board sends in a run of 2 s with noise, driving, a fault and a reset."""
    room = read_room(LIVING_ROOM)
    world = world_of(room, ROBOT, DRIVE, SimConfig(), DemoHand(room.waypoints, seed), seed)
    with simulation(world, tuple(kinds), implementation) as running:
        # The host's order is always the same: only the boards' own shall differ.
        lines = {kind: BaseLine(running) if kind is BoardKind.BASE else Line(running, kind) for kind in sorted(kinds)}
        for millisecond in range(2000):
            for line in lines.values():
                if isinstance(line, BaseLine):
                    drive(line, millisecond)
                else:
                    tick(line, millisecond)
                line.push()
            if millisecond == 1200:
                world.sonars[0].fault = SonarFault.WILD
                if reset is not None:
                    running.reset(reset, ResetCause.WATCHDOG)
            running.step()
            for line in lines.values():
                line.pull()
        assert all(board.model.errors == 0 for board in running.boards.values())
        return {kind: hashlib.sha256(line.received).hexdigest() for kind, line in lines.items()}


@cache
def calm_bytes(implementation: Implementation) -> dict[BoardKind, str]:
    """Those of all boards in a run without a reset, with which the other runs are compared."""
    return bytes_of(implementation, ALL)


def test_two_runs_are_alike_to_the_byte(implementation: Implementation) -> None:
    assert calm_bytes(implementation) == bytes_of(implementation, ALL)


def test_the_order_of_the_boards_does_not_matter(implementation: Implementation) -> None:
    assert calm_bytes(implementation) == bytes_of(implementation, ALL[::-1])


def test_a_board_alone_sends_what_it_sends_among_others(implementation: Implementation) -> None:
    alone = bytes_of(implementation, (BoardKind.BASE,))
    assert alone == {BoardKind.BASE: calm_bytes(implementation)[BoardKind.BASE]}


def test_a_reset_of_one_board_leaves_the_others_bytes_alone(implementation: Implementation) -> None:
    calm = calm_bytes(implementation)
    disturbed = bytes_of(implementation, ALL, reset=BoardKind.JOYSTICK)
    assert disturbed[BoardKind.BASE] == calm[BoardKind.BASE]
    assert disturbed[BoardKind.RANGER] == calm[BoardKind.RANGER]
    assert disturbed[BoardKind.JOYSTICK] != calm[BoardKind.JOYSTICK]


def test_another_seed_is_another_run(implementation: Implementation) -> None:
    first, second = calm_bytes(implementation), bytes_of(implementation, ALL, seed=2)
    assert first[BoardKind.RANGER] != second[BoardKind.RANGER]
    assert first[BoardKind.JOYSTICK] != second[BoardKind.JOYSTICK]
