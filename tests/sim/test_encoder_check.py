"""`giraff check encoders` on the real firmware: it finds what is wrong with the disks that the world was given."""

import json
import math
import os
import signal
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Final

import pytest
import tomlkit

from giraff_core.robot import WIRING, RobotConfig
from giraff_node.boards.board_link import BoardLink
from giraff_node.boards.serial_link import SerialLink
from giraff_node.config.robot_file import load
from giraff_schemas.boards import BASE_BOARD, BoardType
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_setup.encoder import check as encoders
from giraff_setup.wheels import bench
from giraff_sim.board import ROOT, Board, Implementation, open_board
from tests.support.encoder_disks import disk

STEP_MS: Final = 10
MOTOR_MS: Final = 150.0
FLICKER_MS: Final = 20


class SimulatedPort(SerialLink):
    """The port of a simulated board whose wheels turn by what their motors get. Its time goes on while it is read."""

    def __init__(self, board: Board, robot: RobotConfig, max_level: int = 70) -> None:
        super().__init__("simulated", BASE_BOARD.baud)
        self.fault = NO_TROUBLE
        self.now_ms = 0
        self.interrupt_ms = math.inf
        """When somebody presses Ctrl-C."""
        self.on_drive: Callable[[], None] = lambda: None
        """Called while a motor is driven."""
        self.flickers: int | None = None
        """Number of the encoder that counts to and fro while its wheel stands."""
        self.runs_on = False
        """A motor that has turned does not stop, whatever it gets."""
        self.is_closed = False
        self.driven: list[tuple[float, float]] = []
        """PWM counts of both motors in each millisecond."""
        self._board = board
        self._speed = [0.0, 0.0]
        self._turned = [0.0, 0.0]
        self._states_per_count = 2.0 * robot.ticks_per_metre * robot.max_wheel_speed / max_level
        self._always_ready = os.open(os.devnull, os.O_RDONLY)

    def keep_open(self, now: float) -> bool:
        del now
        self.opened += 1
        return self.opened == 1

    def descriptor(self) -> int:
        return self._always_ready

    def flush(self) -> None:
        pass

    def send(self, frame: bytes) -> None:
        assert self._board.write(frame) == len(frame)

    def close(self, why: Trouble) -> None:
        del why
        self.is_closed = True
        self.run(STEP_MS)
        os.close(self._always_ready)

    def read(self) -> bytes:
        if self.now_ms >= self.interrupt_ms:
            raise KeyboardInterrupt
        return self.run(STEP_MS)

    def run(self, milliseconds: int) -> bytes:
        """Let so much time pass; return what the board sends."""
        data = b""
        for _ in range(milliseconds):
            for number, motor in enumerate(self._board.model.motor):
                if motor.drive or not self.runs_on:
                    self._speed[number] += (motor.drive * self._states_per_count - self._speed[number]) / MOTOR_MS
                if abs(self._speed[number]) < 1.0:
                    self._speed[number] = 0.0
                self._turned[number] += self._speed[number] / 1000.0
                motor.position = self._turned[number]
                if self.flickers == number and not self._speed[number] and self.now_ms // FLICKER_MS % 2:
                    motor.position = (math.floor(motor.position) ^ 1) + 0.5  # beyond the edge of A that is next to it
            self.now_ms += 1
            self._board.run(self.now_ms * 1000)
            self.driven.append((self._board.model.motor[0].drive, self._board.model.motor[1].drive))
            data += self._board.read()
        if any(self.driven[-1]):
            self.on_drive()
        return data


@pytest.fixture
def board() -> Iterator[Board]:
    made = open_board(BASE_BOARD, Implementation.HOST)
    yield made
    made.close()


@pytest.fixture
def port(board: Board, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[SimulatedPort]:
    """The port of a robot whose wiring is checked, with a human who has lifted its wheels."""
    path = tmp_path / "robot.toml"
    tables = tomlkit.parse((ROOT / "deploy" / "robot.toml").read_text())
    tables["base"]["drive"].update(dict.fromkeys(WIRING, False))
    path.write_text(tomlkit.dumps(tables))
    monkeypatch.setenv("GIRAFF_CONFIG", str(path))
    monkeypatch.setattr("builtins.input", lambda _question: "lifted")
    made = SimulatedPort(board, load("robot", RobotConfig))

    def link(path: str, board: BoardType) -> BoardLink:
        return BoardLink(path, board, made)

    monkeypatch.setattr(bench, "BoardLink", link)
    monkeypatch.setattr(bench, "time", SimpleNamespace(monotonic=lambda: made.now_ms / 1000.0))
    handlers = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)}
    yield made
    for number, handler in handlers.items():
        signal.signal(number, handler)


def test_each_wheel_turns_alone_and_its_disk_is_judged_rightly(
    board: Board, port: SimulatedPort, capsys: pytest.CaptureFixture[str]
) -> None:
    """The pins of encoder 1 have channel B the other way round: 60 degrees are 240 there."""
    board.set_disk(0, disk(phase=60.0, b=0.4))
    board.set_disk(1, disk(no_a={11}))
    assert encoders.check_encoders(None, None, as_json=True) == 1
    told = capsys.readouterr()
    found = json.loads(told.out)
    left, right = found["left"], found["right"]
    assert left["b_after_a"] == pytest.approx(60 / 360, abs=0.01)
    assert (left["a"]["duty"], left["b"]["duty"]) == (pytest.approx(0.5, abs=0.01), pytest.approx(0.4, abs=0.01))
    assert right["b_after_a"] == pytest.approx(270 / 360, abs=0.01)
    assert right["a"]["turn"] == {"states": 160, "marks": 1}
    assert [left["a"]["missing"], left["b"]["missing"], right["b"]["missing"]] == [0, 0, 0]
    assert [len(left["troubles"]), len(right["troubles"])] == [2, 1], told.err
    assert all(left >= 0 <= right and not (left and right) for left, right in port.driven)
    assert {max(drives) for drives in zip(*port.driven, strict=True)} == {25.0}
    assert port.is_closed
    assert port.driven[-1] == (0.0, 0.0)


@pytest.mark.parametrize("at_ms", [20, 900, 4300])
def test_interrupted_at_any_moment_both_motors_are_at_zero_at_once(
    port: SimulatedPort, capsys: pytest.CaptureFixture[str], at_ms: int
) -> None:
    """While the session opens, while a wheel is driven, and while it coasts."""
    port.interrupt_ms = at_ms
    assert encoders.check_encoders(None, None) == 130
    assert "interrupted; the motors are off." in capsys.readouterr().err
    assert any(left for left, _ in port.driven) == (at_ms > 100)
    port.run(100)
    assert port.driven[at_ms + 2 * STEP_MS :].count((0.0, 0.0)) == len(port.driven) - at_ms - 2 * STEP_MS


@pytest.mark.parametrize("encoder", [0, 1])
def test_an_encoder_that_counts_on_while_its_wheel_stands_is_named_and_both_are_judged(
    board: Board, port: SimulatedPort, capsys: pytest.CaptureFixture[str], encoder: int
) -> None:
    board.set_disk(0, disk(phase=60.0))
    port.flickers = encoder
    assert encoders.check_encoders(None, None) == 1
    told = capsys.readouterr().out
    assert told.count("counts on while the wheel stands; check the wire") == 1
    assert f"{('left', 'right')[encoder]} wheel: it counts on while the wheel stands" in told
    assert told.count("left wheel: the phase between A and B is 60 of 360 degrees") == 1
    assert "right wheel: B leads by 90 of 360 degrees" in told
    assert port.is_closed
    assert port.driven[-1] == (0.0, 0.0)


def test_the_other_wheel_is_not_driven_while_one_goes_on_turning_by_itself(
    port: SimulatedPort, capsys: pytest.CaptureFixture[str]
) -> None:
    port.runs_on = True
    assert encoders.check_encoders(None, None) == 2
    assert "the wheels do not come to rest at zero; keep hands off them" in capsys.readouterr().err
    assert not any(right for _, right in port.driven)
    assert port.driven[-1] == (0.0, 0.0)


def test_encoders_that_are_swapped_are_named(
    port: SimulatedPort, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("GIRAFF_BASE_DRIVE__SWAP_ENCODERS", "true")
    assert encoders.check_encoders(None, None) == 1
    told = capsys.readouterr().out
    for side, other in (("left", "right"), ("right", "left")):
        assert f"{side} wheel: it was driven, and the encoder of the {other} wheel counted; run giraff check" in told
    assert "stall_level" not in told
    assert port.driven[-1] == (0.0, 0.0)


def test_an_output_that_is_closed_meanwhile_is_not_taken_for_two_fine_encoders(
    port: SimulatedPort, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    reader, writer = os.pipe()
    closing = [reader]
    port.on_drive = lambda: os.close(closing.pop()) if closing else None
    with os.fdopen(writer, "w") as piped, monkeypatch.context() as patch:
        patch.setattr(sys, "stdout", piped)
        assert encoders.check_encoders(None, None) == 1
    assert "standard output was closed before both wheels were judged" in capsys.readouterr().err
    assert any(left for left, _ in port.driven)
    assert not any(right for _, right in port.driven)
    assert port.is_closed
    assert port.driven[-1] == (0.0, 0.0)
