"""The joystick board and its sensor: bring-up, readings, faults, recovery."""

import itertools

import pytest

from giraff_schemas.boards import JOYSTICK_BOARD
from giraff_schemas.wire import TILT_PERIOD_MS, TickFrame, TiltFrame, TiltStatus
from tests.firmware.bench import Bench
from tests.firmware.bno055 import ACCONLY, CONFIG, OPR_MODE, UNIT_SEL, Bno055
from tests.firmware.builds import open_board, with_fault

RESET_MS = 300
UP_MS = 1200  # from power-on to readings, with a sensor as in the datasheet


@pytest.fixture
def sensor(joystick: Bench) -> Bno055:
    return Bno055(joystick)


def statuses(joystick: Bench) -> list[TiltStatus]:
    """Each status, once for each time it was taken."""
    told = [TiltStatus(frame.status) for frame in joystick.all(TiltFrame)]
    return [status for status, _ in itertools.groupby(told)]


def run_until_running(joystick: Bench) -> None:
    while not joystick.all(TiltFrame) or joystick.last(TiltFrame).status != TiltStatus.RUNNING:
        joystick.run(1)
        assert joystick.now_ms < 20_000


def test_the_bring_up_follows_the_datasheet(joystick: Bench, sensor: Bno055) -> None:
    joystick.run(UP_MS)
    (fell, rose), *more = sensor.resets_ms
    assert (fell, more) == (0, [])
    assert rose - fell == pytest.approx(RESET_MS, abs=2)
    (config_at, config), (run_at, run) = sensor.modes
    assert (config, run) == (CONFIG, ACCONLY)
    assert rose + sensor.start_ms <= config_at <= rose + sensor.start_ms + 30
    assert 30 <= run_at - config_at <= 40, "it stalls at power-on when it is hurried here"
    assert joystick.board.registers[UNIT_SEL] == 0, "m/s^2"
    assert joystick.board.registers[OPR_MODE] == ACCONLY
    assert statuses(joystick) == [TiltStatus.STARTING, TiltStatus.RUNNING]
    assert joystick.arrivals(TiltFrame)[-1] == pytest.approx(UP_MS, abs=TILT_PERIOD_MS)


def test_a_running_sensor_is_told_of_50_times_a_second(joystick: Bench, sensor: Bno055) -> None:
    run_until_running(joystick)
    joystick.forget()
    joystick.run(1000)
    told = joystick.all(TiltFrame)
    assert len(told) == 50
    assert {(frame.x, frame.y, frame.z) for frame in told} == {(100, -200, 950)}
    assert {(frame.status, frame.sys_status, frame.sys_error) for frame in told} == {(TiltStatus.RUNNING, 6, 0)}
    assert {later.board_us - earlier.board_us for earlier, later in itertools.pairwise(told)} == {20_000}
    assert {later.seq - earlier.seq for earlier, later in itertools.pairwise(told)} == {1}
    sensor.vector = (-9.8, 0.01, -0.01)
    joystick.run(40)
    assert (joystick.last(TiltFrame).x, joystick.last(TiltFrame).y, joystick.last(TiltFrame).z) == (-980, 1, -1)


@pytest.mark.parametrize("start_ms", [0, 400, 650, 950])
def test_a_sensor_has_a_second_to_start(joystick: Bench, sensor: Bno055, start_ms: int) -> None:
    sensor.start_ms = start_ms
    joystick.run(RESET_MS + 1200)
    assert statuses(joystick) == [TiltStatus.STARTING, TiltStatus.RUNNING]
    assert len(sensor.resets_ms) == 1


def test_a_sensor_that_does_not_answer_is_reset_again_and_again(joystick: Bench, sensor: Bno055) -> None:
    sensor.answers = False
    joystick.run(5000)
    assert statuses(joystick) == [TiltStatus.STARTING, TiltStatus.BUS_FAULT]
    assert len(sensor.resets_ms) == pytest.approx(5000 / (RESET_MS + 1000), abs=1)
    assert {frame.z for frame in joystick.all(TiltFrame)} == {0}
    assert len(joystick.all(TiltFrame)) == pytest.approx(250, abs=1)
    sensor.answers = True
    joystick.run(2 * UP_MS)
    assert joystick.last(TiltFrame).status == TiltStatus.RUNNING


@pytest.mark.parametrize(
    ("attribute", "wrong", "status"),
    [
        ("chip_id", 0xA1, TiltStatus.WRONG_CHIP),
        ("acc_id", 0x00, TiltStatus.WRONG_CHIP),
        ("st_result", 0x0E, TiltStatus.SELF_TEST_FAILED),
        ("st_result", 0x07, TiltStatus.SELF_TEST_FAILED),
    ],
)
def test_a_sensor_that_is_not_what_it_should_be_is_named(
    joystick: Bench, sensor: Bno055, attribute: str, wrong: int, status: TiltStatus
) -> None:
    right = getattr(sensor, attribute)
    setattr(sensor, attribute, wrong)
    joystick.run(4000)
    assert statuses(joystick) == [TiltStatus.STARTING, status]
    assert sensor.modes == []
    setattr(sensor, attribute, right)
    joystick.run(2 * UP_MS + 1000)
    assert joystick.last(TiltFrame).status == TiltStatus.RUNNING


def test_the_self_tests_of_sensors_not_used_do_not_matter(joystick: Bench, sensor: Bno055) -> None:
    sensor.st_result = 0x09
    joystick.run(UP_MS)
    assert joystick.last(TiltFrame).status == TiltStatus.RUNNING


def test_one_reading_that_fails_is_told_of_and_changes_nothing(joystick: Bench, sensor: Bno055) -> None:
    run_until_running(joystick)
    joystick.forget()
    sensor.answers = False
    joystick.run(TILT_PERIOD_MS)
    sensor.answers = True
    joystick.run(200)
    told = joystick.all(TiltFrame)
    assert [frame.status for frame in told].count(TiltStatus.BUS_FAULT) == 1
    assert {(frame.x, frame.y, frame.z) for frame in told if frame.status == TiltStatus.BUS_FAULT} == {(0, 0, 0)}
    assert len(sensor.resets_ms) == 1


def test_readings_that_fail_now_and_then_do_not_add_up(joystick: Bench, sensor: Bno055) -> None:
    run_until_running(joystick)
    joystick.forget()
    for _ in range(20):
        sensor.answers = False
        joystick.run(TILT_PERIOD_MS)
        sensor.answers = True
        joystick.run(2 * TILT_PERIOD_MS)
    assert len(sensor.resets_ms) == 1
    assert [frame.status for frame in joystick.all(TiltFrame)].count(TiltStatus.BUS_FAULT) == 20


def test_a_sensor_that_stops_answering_is_brought_up_anew(joystick: Bench, sensor: Bno055) -> None:
    run_until_running(joystick)
    joystick.forget()
    sensor.answers = False
    died_at = joystick.now_ms
    joystick.run(300)
    assert statuses(joystick) == [TiltStatus.BUS_FAULT]
    assert joystick.model.slave_reset
    sensor.answers = True
    run_until_running(joystick)
    assert joystick.now_ms - died_at < 100 + UP_MS + 2 * TILT_PERIOD_MS
    assert len(sensor.resets_ms) == 2


def test_all_zero_is_a_fault_of_the_bus_since_gravity_is_never_zero(joystick: Bench, sensor: Bno055) -> None:
    run_until_running(joystick)
    joystick.forget()
    sensor.vector = (0.0, 0.0, 0.0)
    joystick.run(200)
    assert statuses(joystick)[-1] == TiltStatus.BUS_FAULT
    assert joystick.model.slave_reset
    sensor.vector = (0.0, 0.0, 0.01)
    run_until_running(joystick)
    assert joystick.last(TiltFrame).z == 1


def test_a_system_error_is_told_with_its_number(joystick: Bench, sensor: Bno055) -> None:
    run_until_running(joystick)
    joystick.forget()
    sensor.error = 3
    joystick.run(60)
    told = joystick.last(TiltFrame)
    assert (told.status, told.sys_status, told.sys_error) == (TiltStatus.SYSTEM_ERROR, 1, 3)
    assert (told.x, told.y, told.z) == (0, 0, 0)
    joystick.run(200)
    assert joystick.model.slave_reset
    sensor.error = 0
    run_until_running(joystick)


def test_a_sensor_that_has_reset_itself_is_noticed(joystick: Bench, sensor: Bno055) -> None:
    """A dip of its supply: it is back in its configuration mode, and its data stand still or are zero."""
    run_until_running(joystick)
    joystick.forget()
    joystick.board.registers[OPR_MODE] = CONFIG
    joystick.run(40)
    assert joystick.last(TiltFrame).status != TiltStatus.RUNNING
    run_until_running(joystick)
    assert sensor.modes[-1][1] == ACCONLY


def test_a_bus_that_stands_still_is_let_go_of() -> None:
    board = open_board(JOYSTICK_BOARD, with_fault("stuck_bus", "parts_on_event", board="joystick"))
    joystick = Bench(board)
    sensor = Bno055(joystick)
    run_until_running(joystick)
    joystick.forget()
    joystick.model.button = 1  # as faults/stuck_bus.c has it
    joystick.run(1000)
    told = joystick.all(TiltFrame)
    assert len(told) == pytest.approx(50, abs=1), "it does not lose its rhythm"
    assert set(statuses(joystick)[-1:]) == {TiltStatus.BUS_FAULT}
    joystick.model.button = 0
    run_until_running(joystick)
    assert len(sensor.resets_ms) >= 2
    board.close()


def test_a_frame_carries_the_tick_held_when_its_reading_began(joystick: Bench, sensor: Bno055) -> None:
    run_until_running(joystick)
    assert joystick.last(TiltFrame).tick_epoch == 0
    began_us = joystick.last(TiltFrame).board_us
    joystick.forget()
    for number in range(200):  # one each ms; its 19 bytes take 0.4 ms
        joystick.send(TickFrame(seq=number, epoch=5, robot_ns=joystick.now_ms))
        joystick.run(1)
    told = [frame for frame in joystick.all(TiltFrame) if frame.tick_epoch]
    assert len(told) >= 9
    assert sensor.answers
    for frame in told:
        assert frame.board_us > began_us
        assert frame.tick_robot_ns == frame.board_us // 1000 - 1


def test_the_button_is_in_every_frame_also_without_a_sensor(joystick: Bench) -> None:
    joystick.run(100)
    assert joystick.last(TiltFrame).button == 0
    joystick.model.button = 1
    joystick.run(2 * TILT_PERIOD_MS)
    assert joystick.last(TiltFrame).button == 1
    joystick.model.button = 0
    joystick.run(2 * TILT_PERIOD_MS)
    assert joystick.last(TiltFrame).button == 0
