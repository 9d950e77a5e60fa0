"""`giraff check wheels` with a board and a human made of Python: what is proved is written, a doubt writes nothing."""

import json
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import ClassVar

import pytest

from giraff_schemas.boards import ARDROS_BOARD, BoardType
from giraff_schemas.wire import Latch, Wiring
from giraff_setup.wheels import check as check_wheels
from giraff_setup.wheels.bench import BenchError, Levels
from giraff_setup.wheels.wiring import SIDES, Counted, DoubtError
from giraff_sim.board import ROOT

LEVEL = 25
FIELDS = [bit.name.lower() for bit in Wiring if bit.name is not None]


class Bench:
    """A board that is soldered like `truth`, and stops a wheel that turns against its level as the real one does."""

    truth = Wiring(0)
    latch = Latch.NONE
    dead: Levels | None = None  # nothing turns when this is asked, as where a direction wire is off
    trouble: BaseException | None = None
    made: "ClassVar[Bench]"

    def __init__(self, port: str, board: BoardType, ticks_per_metre: float) -> None:
        self.port, self.board, self.ticks_per_metre = port, board, ticks_per_metre
        self.drives: list[Levels] = []
        Bench.made = self

    def open(self) -> None:
        if self.trouble is not None:
            raise self.trouble

    def close(self) -> None:
        self.closed = True

    def drive(self, wiring: Wiring, levels: Levels, seconds: float, stall_level: int) -> tuple[Counted, Latch]:
        assert max(map(abs, levels)) == LEVEL
        assert seconds <= 1.0
        self.drives.append(levels)
        side = 0 if levels.left else 1
        assert not levels[1 - side], "one at a time"
        if levels == self.dead:
            return Counted(0, 0), Latch.LEFT_STUCK if stall_level <= LEVEL else Latch.NONE
        motor = side ^ int(Wiring.SWAP_MOTORS in wiring)
        wheel = motor ^ int(Wiring.SWAP_MOTORS in self.truth)
        forward = (has(wiring, side, "MOTOR") == has(self.truth, wheel, "MOTOR")) == (levels[side] > 0)
        encoder = wheel ^ int(Wiring.SWAP_ENCODERS in self.truth)
        counter = encoder ^ int(Wiring.SWAP_ENCODERS in wiring)
        counts_up = forward != (has(self.truth, wheel, "ENCODER") != has(wiring, counter, "ENCODER"))
        counted = [0, 0]
        counted[counter] = 400 if counts_up else -400
        if counter == side and counts_up != (levels[side] > 0):
            counted[counter] //= 10
            return Counted(*counted), (Latch.LEFT_OPPOSITE, Latch.RIGHT_OPPOSITE)[side]
        judged = stall_level <= LEVEL and counter != side
        return Counted(*counted), Latch.LEFT_STUCK if judged else self.latch


def has(wiring: Wiring, side: int, part: str) -> bool:
    return Wiring[f"INVERT_{SIDES[side].upper()}_{part}"] in wiring


@pytest.fixture
def path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    copy = tmp_path / "robot.toml"
    stock = (ROOT / "deploy" / "robot.toml").read_text()
    copy.write_text(stock.replace('type = "wheels"', 'type = "wheels"\nboard = "ardros"'))
    monkeypatch.setenv("GIRAFF_CONFIG", str(copy))
    monkeypatch.setattr(check_wheels, "WheelBench", Bench)
    for name in ("truth", "latch", "dead", "trouble"):
        monkeypatch.setattr(Bench, name, getattr(Bench, name))
    monkeypatch.setattr("signal.signal", lambda *_: None)
    return copy


def answer(monkeypatch: pytest.MonkeyPatch, *answers: str) -> None:
    """A human who says this, in turn."""
    left = list(answers)

    def say(_question: str) -> str:
        if not left:
            raise EOFError
        return left.pop(0)

    monkeypatch.setattr("builtins.input", say)


def honest(truth: Wiring) -> list[str]:
    """Answers of one who sees what happens."""
    answers = ["lifted"]
    for motor in (0, 1):
        wheel = motor ^ int(Wiring.SWAP_MOTORS in truth)
        answers += [SIDES[wheel], "backward" if has(truth, wheel, "MOTOR") else "forward"]
    return [*answers, "yes", "yes"]


@pytest.mark.parametrize("bits", range(64))
def test_any_wiring_is_found_proved_and_written(
    bits: int, path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    truth = Wiring(bits)
    monkeypatch.setattr(Bench, "truth", truth)
    answer(monkeypatch, *honest(truth))
    before = path.read_bytes()
    assert check_wheels.check_wheels("port", as_json=True) == 0
    robot = tomllib.loads(path.read_text(encoding="utf-8"))["base"]["drive"]
    assert {name: robot[name] for name in FIELDS} == {name: Wiring[name.upper()] in truth for name in FIELDS}
    assert [kept.read_bytes() for kept in path.parent.glob("robot.toml.before-*")] == [before]
    told = {"robot_file": str(path), "table": "base.drive", "wiring": {name: robot[name] for name in FIELDS}}
    assert json.loads(capsys.readouterr().out) == told
    assert Bench.made.board is ARDROS_BOARD
    assert Bench.made.closed


TRUTH = Wiring.SWAP_ENCODERS | Wiring.INVERT_RIGHT_MOTOR


@pytest.mark.parametrize(
    ("answers", "code", "told"),
    [
        ([], 1, "nobody answers"),
        (["no"], 2, "not begun"),
        (["lifted", "none"], 1, "in doubt: the right encoder counted, and no wheel is said to have turned"),
        (["lifted", "left", "forward", "left", "backward"], 1, "both motors are said to turn the left wheel"),
        (["lifted", "right", "forward", "left", "backward", "yes", "no"], 1, "the proof does not agree"),
        (["lifted", "left", "forward", "right", "backward", "yes", "no"], 1, "the proof does not agree"),
        (["lifted", "left", "forward", "right", "backward", "yes"], 1, "nobody answers"),
        (["lifted", "left", "perhaps", "perhaps", "perhaps"], 1, "no answer was one of forward, backward"),
    ],
)
def test_any_doubt_writes_nothing(
    answers: list[str],
    code: int,
    told: str,
    path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    before = path.read_bytes()
    monkeypatch.setattr(Bench, "truth", TRUTH)
    answer(monkeypatch, *answers)
    assert check_wheels.check_wheels("port") == code
    assert told in capsys.readouterr().err
    assert path.read_bytes() == before


@pytest.mark.parametrize(
    ("spoil", "code", "told"),
    [
        (lambda patch: patch.setattr(Bench, "latch", Latch.LEFT_STUCK), 1, "the board stopped the motor: left_stuck"),
        (lambda patch: patch.setattr(Bench, "trouble", BenchError("in use")), 2, "in use. Nothing was written"),
        (lambda patch: patch.setattr(Bench, "trouble", KeyboardInterrupt()), 130, "interrupted; the motors are off"),
        (lambda patch: patch.setattr(check_wheels, "require_right", refuse), 1, "a plug is loose"),
        (lambda patch: patch.setattr(check_wheels, "most_ticks", lambda *_: 399), 1, "the first motor ran far too"),
        (
            lambda patch: drives_one_way(patch, Levels(0, LEVEL), "lifted", "left", "forward", "none"),
            1,
            "the second motor turns backward and not forward; check the wires of its driver's direction inputs",
        ),
        (
            lambda patch: drives_one_way(patch, Levels(0, -LEVEL), *honest(Wiring(0))),
            1,
            "forward and not backward as well: 400 and 0 ticks; check the wires of its driver's direction inputs",
        ),
    ],
)
def test_a_board_in_trouble_writes_nothing(
    spoil: Callable[[pytest.MonkeyPatch], None],
    code: int,
    told: str,
    path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    before = path.read_bytes()
    answer(monkeypatch, *honest(Wiring(0)))
    spoil(monkeypatch)
    assert check_wheels.check_wheels("port") == code
    assert told in capsys.readouterr().err
    assert path.read_bytes() == before
    assert Bench.made.closed


def drives_one_way(patch: pytest.MonkeyPatch, dead: Levels, *answers: str) -> None:
    patch.setattr(Bench, "dead", dead)
    answer(patch, *answers)


def refuse(*_: object) -> None:
    raise DoubtError("a plug is loose")


def test_variables_that_override_the_file_are_named(
    path: Path,  # noqa: ARG001
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setenv("GIRAFF_BASE_DRIVE__SWAP_MOTORS", "true")
    answer(monkeypatch, *honest(Wiring(0)))
    assert check_wheels.check_wheels("port") == 0
    assert "still override it: GIRAFF_BASE_DRIVE__SWAP_MOTORS" in capsys.readouterr().out
