"""`giraff check encoders` with a board made of Python: it says what is wrong, and the wheels stand whatever ends it."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar

import msgspec
import pytest
import tomlkit

from giraff_core.robot import WIRING
from giraff_schemas.boards import BoardType
from giraff_schemas.wire import Frame, Latch, WheelsFrame, Wiring
from giraff_schemas.wires.transitions import TRANSITIONS_MAX, TransitionsFrame, TransitionsRequestFrame
from giraff_setup.encoder import check as encoders
from giraff_setup.encoder.transitions import Transition
from giraff_setup.wheels.bench import BenchError, Levels, Watch
from giraff_setup.wheels.wiring import Counted
from giraff_sim.board import ROOT
from tests.support.encoder_disks import disk, turned

WHEELS = WheelsFrame(*[0] * 19)


def words(transitions: Sequence[Transition]) -> list[int]:
    """Return them as a board writes them."""
    return [
        each.levels[0] << 15 | each.levels[1] << 14 | (0x3FFF if each.after_ms is None else round(each.after_ms * 72))
        for each in transitions
    ]


class Bench:
    """A board whose encoders 0 and 1 tell what `told` says; the left wheel has number 1."""

    told: ClassVar[Mapping[int, Sequence[int]]] = {}
    is_mute = False
    counted = Counted(500, 500)
    latch = Latch.NONE
    loses = 0
    ends: ClassVar[Mapping[str, BaseException]] = {}
    drives: ClassVar[list[Levels]] = []
    closed = False

    def __init__(self, port: str, board: BoardType, ticks_per_metre: float) -> None:
        del port, board, ticks_per_metre
        Bench.closed = False
        Bench.drives.clear()
        self._seq = 0

    def open(self) -> None:
        self._end("open")

    def close(self) -> None:
        Bench.closed = True

    def drive(
        self, wiring: Wiring, levels: Levels, seconds: float, stall_level: int, watch: Watch
    ) -> tuple[Counted, Latch]:
        assert Wiring.SWAP_ENCODERS in wiring
        assert max(levels) == stall_level == 25
        assert min(levels) == 0, "forward, and one at a time"
        assert seconds <= 5.0
        self.drives.append(levels)
        left = list(self.told[1 if levels.left else 0])
        for millisecond in range(0, 4000, 10):
            self._end("driving", millisecond)
            asked = watch(self._numbered(WHEELS, board_us=millisecond * 1000, left_ticks=millisecond))
            if asked is None:
                continue
            assert isinstance(asked, TransitionsRequestFrame)
            assert asked.encoder == (1 if levels.left else 0)
            for _ in range(0 if self.is_mute else 4):
                said, left = left[:TRANSITIONS_MAX], left[TRANSITIONS_MAX:]
                frame = TransitionsFrame(
                    0, 0, 0, asked.encoder, len(said), (*said, *[0] * (TRANSITIONS_MAX - len(said)))
                )
                numbered = self._numbered(frame)
                if not self.loses or numbered.seq % self.loses:
                    assert watch(numbered) is None
        return self.counted, self.latch

    def _numbered(self, frame: Frame, **fields: int) -> Frame:
        self._seq += 1
        return msgspec.structs.replace(frame, seq=self._seq, **fields)

    def _end(self, where: str, millisecond: int = 2000) -> None:
        if where in self.ends and millisecond == 2000:
            raise self.ends[where]


@pytest.fixture
def path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The file of a robot whose wiring is checked, with a human who has lifted its wheels."""
    copy = tmp_path / "robot.toml"
    tables = tomlkit.parse((ROOT / "deploy" / "robot.toml").read_text())
    tables["base"]["drive"].update({name: name == "swap_encoders" for name in WIRING})
    copy.write_text(tomlkit.dumps(tables))
    monkeypatch.setenv("GIRAFF_CONFIG", str(copy))
    monkeypatch.setattr(encoders, "WheelBench", Bench)
    monkeypatch.setattr("builtins.input", lambda _question: "lifted")
    monkeypatch.setattr(Bench, "told", {0: words(turned(disk())), 1: words(turned(disk(-90.0)))})
    for name in ("counted", "latch", "is_mute", "loses", "ends"):
        monkeypatch.setattr(Bench, name, getattr(Bench, name))
    monkeypatch.setattr("signal.signal", lambda *_: None)
    return copy


def tell(monkeypatch: pytest.MonkeyPatch, **made: Any) -> None:
    """Let the left encoder be of such a disk."""
    monkeypatch.setattr(Bench, "told", {**Bench.told, 1: words(turned(disk(**made)))})


def test_two_good_encoders_are_fine(path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = path.read_bytes()
    assert encoders.check_encoders("port", None) == 0
    told = capsys.readouterr()
    assert "left wheel: B leads by 90 of 360 degrees" in told.out
    assert "right wheel: A leads by 90 of 360 degrees" in told.out
    assert "Both encoders are fine." in told.out
    assert told.err == ""
    assert (Bench.drives, Bench.closed) == ([(25, 0), (0, 25)], True)
    assert path.read_bytes() == before


def test_what_is_wrong_is_said_drawn_and_written(
    path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    tell(monkeypatch, phase=60.0, b=0.4, no_a={7})
    svg = path.with_name("traces.svg")
    assert encoders.check_encoders("port", svg, as_json=True) == 1
    told = capsys.readouterr()
    assert "left wheel: the phase between A and B is 60 of 360 degrees, not 90; move sensor B by 0.08" in told.err
    assert "left wheel: sensor B is high for 40 % of a pair" in told.err
    assert "right wheel: the" not in told.err
    assert "1 in 160 states" in told.err
    found = json.loads(told.out)
    assert found["left"]["b_after_a"] == pytest.approx(60 / 360, abs=0.01)
    assert found["left"]["a"]["turn"] == {"states": 160, "marks": 1}
    assert len(found["left"]["troubles"]) == 3
    assert found["right"]["troubles"] == []
    assert svg.read_text(encoding="utf-8").count("wheel: A leads by") == 2


@pytest.mark.parametrize(
    ("fields", "code", "told"),
    [
        (
            {"is_mute": True},
            2,
            "the board's firmware does not tell transitions; flash it: make -C firmware flash BOARD=base",
        ),
        ({"ends": {"open": BenchError("in use by another process")}}, 2, "in use by another process"),
        ({"ends": {"open": KeyboardInterrupt()}}, 130, "interrupted; the motors are off."),
        ({"ends": {"driving": KeyboardInterrupt()}}, 130, "interrupted; the motors are off."),
        ({"ends": {"driving": BenchError("the board was reset in between")}}, 2, "reset in between"),
    ],
)
def test_whatever_ends_it_the_port_is_given_back(
    path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    fields: dict[str, Any],
    code: int,
    told: str,
) -> None:
    before = path.read_bytes()
    for name, value in fields.items():
        monkeypatch.setattr(Bench, name, value)
    assert encoders.check_encoders("port", None) == code
    assert told in capsys.readouterr().err
    assert Bench.closed
    assert path.read_bytes() == before


@pytest.mark.parametrize(
    ("latch", "counted", "made", "told"),
    [
        (
            Latch.LEFT_STUCK,
            0,
            None,
            "left wheel: it was driven, and its encoder gave nothing; check battery, motor",
        ),
        (Latch.LEFT_STUCK, 0, {"no_a": range(40)}, "left wheel: sensor A is silent: it did not change while sensor B"),
        (Latch.LEFT_OPPOSITE, -40, {}, "left wheel: it counts backward while it is driven forward; run giraff check"),
    ],
)
def test_a_wheel_that_the_board_stops_is_named_with_the_cause(
    path: Path,  # noqa: ARG001
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    latch: Latch,
    counted: int,
    made: dict[str, Any] | None,
    told: str,
) -> None:
    monkeypatch.setattr(Bench, "latch", latch)
    monkeypatch.setattr(Bench, "counted", Counted(counted, 0))
    tell(monkeypatch, **(made or {}))
    if made is None:
        monkeypatch.setattr(Bench, "told", {**Bench.told, 1: words(turned(disk()))[:3]})
    assert encoders.check_encoders("port", None) == 1
    assert told in capsys.readouterr().out


@pytest.mark.parametrize(
    ("change", "svg", "told"),
    [
        ({"board": "ardros"}, None, "a board of type ardros cannot tell its encoders' transitions"),
        ({"board": "mega_l298n"}, None, "a board of type mega_l298n cannot tell its encoders' transitions"),
        ({"swap_encoders": None}, None, "the wiring is not checked; lift the wheels, then run `giraff check wheels`"),
        ({"type": "balancer"}, None, "[base"),
        ({}, "none/traces.svg", "cannot be written: there is no such folder; make it"),
        ({}, "robot.toml", "robot.toml is there already: name another file, or delete it first"),
    ],
)
def test_what_cannot_be_looked_at_is_refused_before_anything_moves(
    path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], change: Any, svg: str, told: str
) -> None:
    tables = tomlkit.parse(path.read_text(encoding="utf-8"))
    for name, value in change.items():
        if value is None:
            del tables["base"]["drive"][name]
        else:
            tables["base"]["drive"][name] = value
    path.write_text(tomlkit.dumps(tables), encoding="utf-8")
    before = path.read_bytes()
    monkeypatch.setattr("builtins.input", lambda _question: pytest.fail("nobody is asked"))
    assert encoders.check_encoders("port", path.parent / svg if svg else None) == 2
    assert told in capsys.readouterr().err
    assert path.read_bytes() == before


@pytest.mark.parametrize("answer", ["no", "", None])
def test_nothing_moves_before_the_human_says_so(
    path: Path,  # noqa: ARG001
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    answer: str | None,
) -> None:
    def say(_question: str) -> str:
        if answer is None:
            raise EOFError
        return answer

    monkeypatch.setattr("builtins.input", say)
    Bench.drives.clear()
    assert encoders.check_encoders("port", None) == 2
    assert ("nobody answers" if answer is None else "not begun") in capsys.readouterr().err
    assert not Bench.drives


def test_a_frame_that_the_line_loses_is_a_loss_and_no_missing_mark(
    path: Path,  # noqa: ARG001
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr(Bench, "loses", 5)
    assert encoders.check_encoders("port", None, as_json=True) == 0
    assert json.loads(capsys.readouterr().out)["left"]["losses"] > 2
