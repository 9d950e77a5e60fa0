"""Every counter that wraps does so unnoticed: firmware whose counters begin just before it."""

import itertools
from collections.abc import Iterator
from pathlib import Path

import pytest

from giraff_schemas.wire import (
    BoardKind,
    DriveState,
    RangeFrame,
    RangeState,
    TiltFrame,
    TiltStatus,
    WheelsFrame,
)
from giraff_sim.board import Implementation
from giraff_sim.simulation import simulation
from tests.firmware.builds import wrap_soon
from tests.sim.line import BaseLine, Line
from tests.sim.robots import room_with_wall, world_in
from tests.support.wheels import wheels_of


@pytest.fixture(scope="module")
def build() -> Path:
    """A build of all boards, both ways, whose counters wrap soon."""
    return wrap_soon()


@pytest.fixture
def base(implementation: Implementation, build: Path) -> Iterator[BaseLine]:
    """A base board two seconds before its clocks wrap."""
    with simulation(world_in(room_with_wall(50.0)), (BoardKind.BASE,), implementation, build) as running:
        yield BaseLine(running)


def wrapped(later: int, earlier: int, bits: int) -> int:
    """later - earlier, modulo 2^bits, as a signed number."""
    half = 1 << (bits - 1)
    return (later - earlier + half) % (1 << bits) - half


def test_clocks_ticks_and_sequence_wrap_while_the_wheels_turn(base: BaseLine) -> None:
    base.start()
    base.drive(70, 70, 4.0)
    base.drive(0, 0, 1.0)
    told = base.all(WheelsFrame)
    for field, bits in (("board_us", 32), ("board_ms", 32), ("left_ticks", 32), ("right_ticks", 32), ("seq", 16)):
        values = [getattr(frame, field) for frame in told]
        assert any(later < earlier for earlier, later in itertools.pairwise(values)), f"{field} has not wrapped"
        assert all(wrapped(later, earlier, bits) >= 0 for earlier, later in itertools.pairwise(values)), field
    for earlier, later in itertools.pairwise(told):
        assert wrapped(later.seq, earlier.seq, 16) == 1
        assert 9 <= wrapped(later.board_ms, earlier.board_ms, 32) <= 11
        assert 9_000 < wrapped(later.board_us, earlier.board_us, 32) < 11_000
        assert 0 <= wrapped(later.left_ticks, earlier.left_ticks, 32) < 16
    true_ticks = wheels_of(base.simulation.world).plant.left.states / 2
    assert wrapped(told[-1].left_ticks, told[0].left_ticks, 32) == pytest.approx(true_ticks, abs=1)
    assert true_ticks > 1000


def test_driving_goes_on_across_the_wrap_of_the_echoed_time(base: BaseLine) -> None:
    base.start()
    base.drive(50, 50, 4.0)
    assert base.wheels.board_ms < 10_000
    assert base.wheels.refused == 0
    assert base.wheels.drive_state == DriveState.ACTIVE
    verdict = base.simulation.record.window(500_000, base.simulation.now_us)
    assert verdict.driven_ms == (base.simulation.now_us - 500_000) // 1000


def test_a_time_out_and_a_stale_frame_across_the_wrap(base: BaseLine) -> None:
    base.start()
    while base.wheels.board_ms < 0xFFFFFFFF - 100:
        base.drive(50, 50, 0.02)
    old = base.drive_frame(70, 70)
    base.drive(50, 50, 0.02)
    asked_us = base.simulation.now_us
    base.run(0.4)
    verdict = base.simulation.record.window(asked_us - 20_000, base.simulation.now_us)
    assert verdict.last_driven_us == pytest.approx(asked_us - 20_000 + 300_000, abs=10_000)
    assert base.wheels.drive_state == DriveState.COMMAND_TIMEOUT
    base.drive(0, 0, 0.1)
    refused = base.wheels.refused
    base.send(old)
    base.run(0.05)
    assert base.wheels.board_ms < 10_000
    assert base.wheels.refused == refused + 1


def test_drive_frames_whose_sequence_wraps_are_newer(base: BaseLine) -> None:
    base.start()
    base._seq = 0xFFFF - 10
    base.configure()
    base.drive(0, 0, 0.1)
    base.drive(40, 40, 1.0)
    assert base._seq > 0xFFFF
    assert base.wheels.refused == 0
    assert base.wheels.left_pwm_counts == 40


def test_tilts_go_on_across_the_wrap(implementation: Implementation, build: Path) -> None:
    with simulation(world_in(room_with_wall(2.0)), (BoardKind.JOYSTICK,), implementation, build) as running:
        line = Line(running, BoardKind.JOYSTICK)
        line.run(5.0)
        told = line.all(TiltFrame)
        assert len(told) == pytest.approx(250, abs=3)
        assert told[-1].seq < told[0].seq
        assert told[-1].board_us < told[0].board_us
        for earlier, later in itertools.pairwise(told):
            assert wrapped(later.seq, earlier.seq, 16) == 1
            assert 18_000 < wrapped(later.board_us, earlier.board_us, 32) < 22_000
        running_from = next(index for index, frame in enumerate(told) if frame.status == TiltStatus.RUNNING)
        assert all(frame.status == TiltStatus.RUNNING for frame in told[running_from:])


def test_ranges_are_right_across_the_wrap(implementation: Implementation, build: Path) -> None:
    with simulation(world_in(room_with_wall(2.0)), (BoardKind.RANGER,), implementation, build) as running:
        line = Line(running, BoardKind.RANGER)
        line.run(5.0)
        told = [frame for frame in line.all(RangeFrame) if frame.sensor != 2]
        assert told[-1].seq < told[0].seq
        assert told[-1].board_us < told[0].board_us
        assert {frame.state for frame in told} == {RangeState.ECHO}
        assert all(frame.echo_us == pytest.approx(1.75 * 5800, abs=58) for frame in told)


def test_an_echo_that_spans_the_wrap_is_measured(implementation: Implementation, build: Path) -> None:
    with simulation(world_in(room_with_wall(2.0)), (BoardKind.RANGER,), implementation, build) as running:
        asked_us = 390 * 58.0
        running.boards[BoardKind.RANGER].on_ping(lambda _: asked_us)
        line = Line(running, BoardKind.RANGER)
        line.run(3.0)
        told = line.all(RangeFrame)
        assert {frame.state for frame in told} == {RangeState.ECHO}
        assert all(frame.echo_us == pytest.approx(asked_us, abs=58) for frame in told)
        assert any(frame.board_us < 2**32 < frame.board_us + asked_us for frame in told), "no echo spanned it"
