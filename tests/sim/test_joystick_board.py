"""The joystick board's firmware against the BNO055's registers, exact in simulated time."""

import itertools
from collections.abc import Iterator

import pytest

from giraff_schemas.wire import BoardKind, HelloFrame, ResetCause, TickFrame, TiltFrame, TiltStatus
from giraff_sim.board import Implementation
from giraff_sim.simulation import simulation
from giraff_sim.truth import Truth
from giraff_sim.world.bno055 import Bno055, Bno055Fault
from giraff_sim.world.hand import LaidDown
from tests.sim.line import Line
from tests.sim.robots import empty_room, world_in


@pytest.fixture
def joystick(implementation: Implementation) -> Iterator[Line]:
    """A joystick board that has just been powered on."""
    with simulation(world_in(empty_room()), (BoardKind.JOYSTICK,), implementation) as running:
        yield Line(running, BoardKind.JOYSTICK)


def sensor(line: Line) -> Bno055:
    assert line.simulation.bno055 is not None
    return line.simulation.bno055


def run_until_running(line: Line, at_most: float) -> float:
    """Seconds until the sensor is reported as running."""
    began = line.simulation.now_us
    while line.simulation.now_us - began < at_most * 1e6:
        line.step()
        tilts = line.all(TiltFrame)
        if tilts and tilts[-1].status == TiltStatus.RUNNING:
            return (line.simulation.now_us - began) * 1e-6
    raise AssertionError(f"not running after {at_most} s: {line.frames[-1:]}")


def test_it_brings_the_sensor_up_and_tells_its_tilt_50_times_a_second(joystick: Line) -> None:
    joystick.simulation.world.hand = LaidDown((1.5, -2.5, 9.0))
    seconds = run_until_running(joystick, 3.0)
    assert 0.9 < seconds < 2.0  # reset line, start-up time, mode change
    before = joystick.all(TiltFrame)[:-1]
    assert all(frame.status == TiltStatus.STARTING for frame in before)
    assert joystick.last(HelloFrame).board == BoardKind.JOYSTICK
    joystick.run(2.0)
    tilts = joystick.all(TiltFrame)[len(before) + 1 :]
    assert len(tilts) == pytest.approx(100, abs=1)
    assert all((later.seq - earlier.seq) & 0xFFFF == 1 for earlier, later in itertools.pairwise(tilts))
    assert all((frame.x, frame.y, frame.z) == (150, -250, 900) for frame in tilts)
    assert all(frame.sys_status == 6 and frame.sys_error == 0 for frame in tilts)
    assert joystick.damaged == 0


def test_a_sensor_with_an_offset_tells_another_tilt_than_the_true_one(implementation: Implementation) -> None:
    world = world_in(empty_room(), truth=Truth(accelerometer_offset=(0.3, -0.2, 0.1)))
    world.hand = LaidDown((1.5, -2.5, 9.0))
    with simulation(world, (BoardKind.JOYSTICK,), implementation) as running:
        line = Line(running, BoardKind.JOYSTICK)
        run_until_running(line, 3.0)
        line.run(0.2)
        frame = line.last(TiltFrame)
    assert (frame.x, frame.y, frame.z) == (180, -270, 910)
    assert world.acceleration == (1.5, -2.5, 9.0)


@pytest.mark.parametrize(
    ("fault", "status"),
    [
        (Bno055Fault.DEAD, TiltStatus.BUS_FAULT),
        (Bno055Fault.ZERO, TiltStatus.BUS_FAULT),
        (Bno055Fault.SYSTEM_ERROR, TiltStatus.SYSTEM_ERROR),
    ],
)
def test_a_fault_is_told_at_once_and_mended_is_running_again(
    joystick: Line, fault: Bno055Fault, status: TiltStatus
) -> None:
    run_until_running(joystick, 3.0)
    sensor(joystick).fault = fault
    began = joystick.simulation.now_us
    while joystick.last(TiltFrame).status == TiltStatus.RUNNING:
        joystick.step()
    assert joystick.simulation.now_us - began <= 60_000
    seen = {joystick.last(TiltFrame).status}
    frames = len(joystick.frames)
    joystick.run(3.0)
    seen |= {frame.status for _, frame in joystick.frames[frames:] if isinstance(frame, TiltFrame)}
    assert status in seen
    assert TiltStatus.RUNNING not in seen
    sensor(joystick).fault = Bno055Fault.NONE
    assert run_until_running(joystick, 4.0) < 4.0


@pytest.mark.parametrize(
    ("fault", "status"),
    [
        (Bno055Fault.DEAD, TiltStatus.BUS_FAULT),
        (Bno055Fault.WRONG_CHIP, TiltStatus.WRONG_CHIP),
        (Bno055Fault.SELF_TEST, TiltStatus.SELF_TEST_FAILED),
    ],
)
def test_a_sensor_that_cannot_be_brought_up_is_named(joystick: Line, fault: Bno055Fault, status: TiltStatus) -> None:
    sensor(joystick).fault = fault
    joystick.run(4.0)
    statuses = {frame.status for frame in joystick.all(TiltFrame)}
    assert status in statuses
    assert TiltStatus.RUNNING not in statuses
    sensor(joystick).fault = Bno055Fault.NONE
    run_until_running(joystick, 4.0)


def test_a_tilt_carries_the_newest_tick_held_when_it_was_read(joystick: Line) -> None:
    run_until_running(joystick, 3.0)
    assert joystick.last(TiltFrame).tick_epoch == 0
    for number in range(1, 20):
        joystick.send(TickFrame(seq=number, epoch=77, robot_ns=number * 20_000_000 + 2**40))
        joystick.run(0.02)
    tilts = [frame for frame in joystick.all(TiltFrame) if frame.tick_epoch]
    assert {frame.tick_epoch for frame in tilts} == {77}
    stamps = [frame.tick_robot_ns for frame in tilts]
    assert stamps == sorted(stamps)
    assert stamps[-1] >= 18 * 20_000_000 + 2**40


def test_the_button(joystick: Line) -> None:
    run_until_running(joystick, 3.0)
    assert joystick.last(TiltFrame).button == 0
    joystick.simulation.world.button = True
    joystick.run(0.1)
    assert joystick.last(TiltFrame).button == 1
    joystick.simulation.world.button = False
    joystick.run(0.1)
    assert joystick.last(TiltFrame).button == 0


def test_a_reset_in_mid_transfer_recovers(joystick: Line) -> None:
    run_until_running(joystick, 3.0)
    boot_id = joystick.last(TiltFrame).boot_id
    for extra in range(5):
        joystick.run(0.5 + 0.003 * extra)
        joystick.simulation.reset(BoardKind.JOYSTICK, ResetCause.WATCHDOG)
        joystick.run(0.1)
        assert joystick.last(HelloFrame).boot_id == boot_id + 1 + extra
        run_until_running(joystick, 4.0)
