"""Inputs of a motor driver that are off, shorted or dead: `giraff check wheels` finds each on the real firmware."""

import math
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Final

import pytest

from giraff_base.config import BaseConfig
from giraff_base.drives.wheels.config import WheelsConfig
from giraff_core.robot import RobotConfig
from giraff_node.boards.board_link import BoardLink
from giraff_node.config.robot_file import load
from giraff_schemas.boards import BoardType
from giraff_setup.wheels import bench
from giraff_setup.wheels.bench import WheelBench
from giraff_setup.wheels.check import find_wiring, most_ticks
from giraff_setup.wheels.wiring import DoubtError
from giraff_sim.board import ROOT, Board, Implementation, open_board
from tests.sim.test_encoder_check import SimulatedPort

PWM, IN1, IN2 = 0, 1, 2
RPWM, LPWM, R_EN, L_EN = 0, 1, 2, 3
BACKWARD_ALONE: Final = "the first motor turns backward and not forward; check the wires of its driver's direction"
FORWARD_ALONE: Final = "the left wheel turns forward and not backward as well"
DEAD: Final = "the motor was driven and nothing turned"
FULL_POWER: Final = "the first motor ran far too fast"
"""Said of the left wheel's driver, which is motor 0."""

FAULTS: Final = [
    ("mega_l298n", 0, "low", PWM, DEAD),
    ("mega_l298n", 0, "low", IN1, BACKWARD_ALONE),
    ("mega_l298n", 0, "low", IN2, FORWARD_ALONE),
    ("mega_l298n", 0, "high", PWM, FULL_POWER),
    ("mega_l298n", 0, "high", IN1, FORWARD_ALONE),
    ("mega_l298n", 0, "high", IN2, BACKWARD_ALONE),
    ("mega_bts7960", 0, "low", RPWM, BACKWARD_ALONE),
    ("mega_bts7960", 0, "low", LPWM, FORWARD_ALONE),
    ("mega_bts7960", 0, "low", R_EN, DEAD),
    ("mega_bts7960", 0, "low", L_EN, DEAD),
    ("mega_bts7960", 0, "high", RPWM, FULL_POWER),
    ("mega_bts7960", 0, "high", LPWM, FULL_POWER),
    ("mega_bts7960", 1, "high", RPWM, FULL_POWER.replace("first", "second")),
    ("mega_l298n", 1, "low", IN2, FORWARD_ALONE.replace("left", "right")),
]


class Watcher:
    """Sees which wheel turns, and which way: wheel 0 is left, and motor 0 turns it."""

    def __init__(self, board: Board) -> None:
        self._board = board
        self._before = [0.0, 0.0]

    def show(self, text: str) -> None:
        del text

    def ask(self, question: str) -> str:
        now = [float(motor.position) for motor in self._board.model.motor]
        turned = [after - before for after, before in zip(now, self._before, strict=True)]
        wheel = max((0, 1), key=lambda number: abs(turned[number]))
        if "forward, and only that one" in question:
            self._before = now
            return "yes" if turned["right" in question] > 0 else "no"
        if question.startswith("Which wheel"):
            if abs(turned[wheel]) < 1.0:
                return "none"
            return ("left", "right")[wheel]
        self._before = now
        return "forward" if turned[wheel] > 0 else "backward"


@pytest.fixture
def drive(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> WheelsConfig:
    monkeypatch.setenv("GIRAFF_CONFIG", str(ROOT / "deploy" / "robots" / f"{request.param}.toml"))
    given = load("base", BaseConfig).drive
    assert isinstance(given, WheelsConfig)
    return given


@pytest.fixture
def board(drive: WheelsConfig, monkeypatch: pytest.MonkeyPatch) -> Iterator[Board]:
    made = open_board(drive.board_type, Implementation.AVR)
    robot = load("robot", RobotConfig)
    port = SimulatedPort(made, robot, drive.max_level)

    def link(path: str, board: BoardType) -> BoardLink:
        return BoardLink(path, board, port)

    monkeypatch.setattr(bench, "BoardLink", link)
    monkeypatch.setattr(bench, "time", SimpleNamespace(monotonic=lambda: port.now_ms / 1000.0))
    yield made
    made.close()


@pytest.mark.parametrize(("drive", "motor", "kind", "wire", "told"), FAULTS, indirect=["drive"])
def test_a_fault_of_a_driver_is_named(
    drive: WheelsConfig, board: Board, motor: int, kind: str, wire: int, told: str
) -> None:
    setattr(board.model.motor[motor], f"inputs_{kind}", 1 << wire)
    wheels = WheelBench("simulated", drive.board_type, load("robot", RobotConfig).ticks_per_metre)
    wheels.open()
    with pytest.raises(DoubtError, match=told):
        find_wiring(wheels, Watcher(board), drive.stall_level, most_ticks(load("robot", RobotConfig), drive))
    wheels.close()


@pytest.mark.parametrize("drive", ["mega_l298n", "mega_bts7960"], indirect=True)
def test_a_sound_driver_is_found_right(drive: WheelsConfig, board: Board) -> None:
    robot = load("robot", RobotConfig)
    wheels = WheelBench("simulated", drive.board_type, robot.ticks_per_metre)
    wheels.open()
    assert not any(find_wiring(wheels, Watcher(board), drive.stall_level, most_ticks(robot, drive)).values())
    wheels.close()
    assert math.isclose(board.model.motor[0].drive, 0.0)
