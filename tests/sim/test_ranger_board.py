"""The ranger board's firmware against the HC-SR04's pulses, exact in simulated time."""

import itertools
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from giraff_schemas.boards import NANO_RANGER_BOARD, RANGER_BOARD, BoardType
from giraff_schemas.wire import BoardKind, HelloFrame, RangeFault, RangeFrame, RangeState, ResetCause, TickFrame
from giraff_schemas.wires.bumper import BumperFrame, BumperRequestFrame
from giraff_sim.board import ROOT, Board, BoardError, Implementation
from giraff_sim.main import main
from giraff_sim.simulation import simulation
from giraff_sim.world.sonar import NO_ECHO_US, SILENT_US, STUCK_US, SonarFault
from tests.sim.line import Line
from tests.sim.robots import room_with_wall, world_in

US_PER_CM = 58.0


@pytest.fixture
def ranger(implementation: Implementation) -> Iterator[Line]:
    """A ranger board that has just been powered on, the wall 1.75 m before its two front sensors."""
    with simulation(world_in(room_with_wall(2.0)), (BoardKind.RANGER,), implementation) as running:
        yield Line(running, BoardKind.RANGER)


def hear(line: Line, echo_us: Callable[[int], float]) -> None:
    """Put other echoes in the world's place."""
    board: Board = line.simulation.boards[BoardKind.RANGER]
    board.on_ping(echo_us)


def ranges_of(line: Line, seconds: float) -> list[RangeFrame]:
    line.run(0.3)
    frames = len(line.all(RangeFrame))
    line.run(seconds)
    return line.all(RangeFrame)[frames:]


def test_it_pings_one_sensor_in_60_ms_in_turn(ranger: Line) -> None:
    told = ranges_of(ranger, 9.0)
    assert ranger.last(HelloFrame).board == BoardKind.RANGER
    assert len(told) == pytest.approx(150, abs=1)
    assert all((later.seq - earlier.seq) & 0xFFFF == 1 for earlier, later in itertools.pairwise(told))
    assert all((later.sensor - earlier.sensor) % 3 == 1 for earlier, later in itertools.pairwise(told))
    periods = [later.board_us - earlier.board_us for earlier, later in itertools.pairwise(told)]
    assert min(periods) >= 59_000
    assert max(periods) <= 62_000
    assert {frame.state for frame in told if frame.sensor < 2} == {RangeState.ECHO}
    assert all(frame.echo_us == pytest.approx(175 * US_PER_CM, abs=US_PER_CM / 2) for frame in told if frame.sensor < 2)
    assert {frame.state for frame in told if frame.sensor == 2} == {RangeState.CLEAR}
    assert ranger.simulation.world.sonars[0].pings == pytest.approx(ranger.simulation.world.sonars[2].pings, abs=1)


def test_a_bumpers_pin_comes_up_once_the_board_is_asked(ranger: Line) -> None:
    pins = ranger.simulation.boards[BoardKind.RANGER].model.bumper_open
    pins[1] = 1
    ranger.run(0.3)
    assert ranger.all(BumperFrame) == []
    ranger.send(BumperRequestFrame(seq=1))
    ranger.run(0.3)
    assert {frame.open for frame in ranger.all(BumperFrame)} == {2}
    pins[0] = 1
    ranger.simulation.reset(BoardKind.RANGER, ResetCause.WATCHDOG)
    ranger.frames.clear()
    ranger.run(0.3)
    assert ranger.all(BumperFrame) == []
    ranger.send(BumperRequestFrame(seq=2))
    ranger.run(0.3)
    pins[1] = 0
    ranger.run(0.1)
    assert [pushed for pushed, _ in itertools.groupby(frame.open for frame in ranger.all(BumperFrame))] == [3, 1]
    assert ranger.damaged == 0
    assert len(ranger.all(RangeFrame)) == pytest.approx(11, abs=1)


def test_2_to_395_cm_come_out_within_a_centimetre(ranger: Line) -> None:
    centimetres = itertools.cycle([2.0, 3.0, 4.3, 7.7, 20.0, 37.1, 90.0, 151.5, 200.0, 289.0, 350.5, 394.9, 395.0])
    asked: list[float] = []

    def echo(_sonar: int) -> float:
        asked.append(next(centimetres))
        return asked[-1] * US_PER_CM

    hear(ranger, echo)
    ranger.run(5.0)
    told = ranger.all(RangeFrame)
    assert len(told) > 78
    for frame, distance in zip(told, asked, strict=False):
        assert frame.state == RangeState.ECHO
        assert frame.fault == RangeFault.NONE
        assert frame.echo_us / US_PER_CM == pytest.approx(distance, abs=1.0)


@pytest.mark.parametrize("echo_us", [410 * US_PER_CM, 500 * US_PER_CM, NO_ECHO_US, 60_000.0])
def test_from_410_cm_or_without_an_echo_it_is_clear_and_no_phantom_at_90_cm(ranger: Line, echo_us: float) -> None:
    hear(ranger, lambda _: echo_us)
    told = ranges_of(ranger, 3.0)
    assert len(told) > 30
    assert {frame.state for frame in told} == {RangeState.CLEAR}


def test_a_silent_sensor_is_a_fault_and_comes_back(ranger: Line) -> None:
    ranger.run(1.0)
    ranger.simulation.world.sonars[1].fault = SonarFault.DEAD
    told = ranges_of(ranger, 2.0)
    assert {(frame.state, frame.fault) for frame in told if frame.sensor == 1} == {
        (RangeState.FAULT, RangeFault.NO_ECHO_PULSE)
    }
    assert {frame.state for frame in told if frame.sensor == 0} == {RangeState.ECHO}
    ranger.simulation.world.sonars[1].fault = SonarFault.NONE
    assert {frame.state for frame in ranges_of(ranger, 2.0) if frame.sensor == 1} == {RangeState.ECHO}


def test_a_stuck_echo_line_is_a_fault_and_comes_back(ranger: Line) -> None:
    ranger.run(1.0)
    ranger.simulation.world.sonars[0].fault = SonarFault.STUCK
    ranger.run(0.5)
    told = ranges_of(ranger, 3.0)
    assert {(frame.state, frame.fault) for frame in told if frame.sensor == 0} == {
        (RangeState.FAULT, RangeFault.STUCK_HIGH)
    }
    assert {frame.state for frame in told if frame.sensor == 1} == {RangeState.ECHO}
    ranger.simulation.world.sonars[0].fault = SonarFault.NONE
    ranger.run(1.0)
    assert {frame.state for frame in ranges_of(ranger, 2.0) if frame.sensor == 0} == {RangeState.ECHO}


def test_a_pulse_shorter_than_any_range_is_a_fault(ranger: Line) -> None:
    hear(ranger, lambda sonar: 30.0 if sonar == 2 else 5800.0)
    told = ranges_of(ranger, 2.0)
    assert {(frame.state, frame.fault) for frame in told if frame.sensor == 2} == {
        (RangeState.FAULT, RangeFault.TOO_SHORT)
    }


def test_every_kind_of_answer_in_turn_stays_with_its_sensor(ranger: Line) -> None:
    answers = {0: 5800.0, 1: SILENT_US, 2: STUCK_US}
    hear(ranger, lambda sonar: answers[sonar])
    told = ranges_of(ranger, 3.0)
    assert {(frame.sensor, frame.state) for frame in told} == {
        (0, RangeState.ECHO),
        (1, RangeState.FAULT),
        (2, RangeState.FAULT),
    }


@pytest.mark.parametrize("board", [RANGER_BOARD, NANO_RANGER_BOARD], ids=lambda board: str(board.name))
def test_overlapping_echoes_stay_apart_on_the_real_board(board: BoardType) -> None:
    """Clones hold their line high for 180 ms, during which the others answer."""
    answers = {0: 5800.0, 1: 180_000.0, 2: 11_600.0}
    world = world_in(room_with_wall(2.0))
    with simulation(world, (BoardKind.RANGER,), Implementation.AVR, ranger=board) as running:
        line = Line(running, BoardKind.RANGER)
        hear(line, lambda sensor: answers[sensor])
        line.run(0.05)
        line.send(BumperRequestFrame(seq=1))
        line.run(0.05)
        for bumper in range(2):
            running.boards[BoardKind.RANGER].model.bumper_open[bumper] = 1
            line.run(0.45)
    assert line.last(HelloFrame).board == board.number
    told = line.all(RangeFrame)
    assert len(told) > 10
    assert {frame.sensor: frame.state for frame in told} == {
        0: RangeState.ECHO,
        1: RangeState.CLEAR,
        2: RangeState.ECHO,
    }
    assert all(frame.echo_us == pytest.approx(answers[frame.sensor], abs=20) for frame in told)
    assert [switches for switches, _ in itertools.groupby(frame.open for frame in line.all(BumperFrame))] == [0, 1, 3]


def test_the_simulator_opens_the_board_that_the_robot_file_names(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened: list[BoardType] = []

    def none_is_built(board: BoardType, *_: object) -> Board:
        opened.append(board)
        raise BoardError("none is built")

    monkeypatch.setenv("GIRAFF_CONFIG", str(ROOT / "deploy" / "robot.toml"))
    monkeypatch.setenv("GIRAFF_RANGER_BOARD", "nano_ranger")
    monkeypatch.setattr("giraff_sim.simulation.open_board", none_is_built)
    monkeypatch.setattr("giraff_sim.main.service_logger", lambda _name: None)
    room = str(ROOT / "deploy" / "worlds" / "living_room.toml")
    options = {"--ports": str(tmp_path), "--control": str(tmp_path / "c"), "--world": room, "--only": "ranger"}
    assert main([word for option in options.items() for word in option]) == 1
    assert opened == [NANO_RANGER_BOARD]


def test_a_range_carries_the_newest_tick_held_at_its_trigger(ranger: Line) -> None:
    ranger.run(0.3)
    assert ranger.last(RangeFrame).tick_epoch == 0
    for number in range(1, 50):
        ranger.send(TickFrame(seq=number, epoch=5, robot_ns=number * 20_000_000))
        ranger.run(0.02)
    stamped = [frame for frame in ranger.all(RangeFrame) if frame.tick_epoch]
    assert len(stamped) > 12
    for earlier, later in itertools.pairwise(stamped):
        assert later.tick_robot_ns - earlier.tick_robot_ns == pytest.approx(60_000_000, abs=20_000_001)


def test_a_reset_in_the_middle_of_an_echo_recovers(ranger: Line) -> None:
    hear(ranger, lambda _: NO_ECHO_US)
    ranger.run(1.015)
    boot_id = ranger.last(RangeFrame).boot_id
    ranger.simulation.reset(BoardKind.RANGER, ResetCause.WATCHDOG)
    hear(ranger, lambda _: 100 * US_PER_CM)
    told = ranges_of(ranger, 2.0)
    assert {frame.boot_id for frame in told} == {boot_id + 1}
    assert {frame.state for frame in told} == {RangeState.ECHO}
    assert all(frame.echo_us == pytest.approx(5800.0, abs=58.0) for frame in told)
