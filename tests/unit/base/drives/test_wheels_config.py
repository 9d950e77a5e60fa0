"""What the base board is told of a robot, and which robots cannot be told of."""

import math
from contextlib import nullcontext
from typing import Final

import msgspec
import pytest

from giraff_base.drives.wheels.config import SpeedControl, WheelsConfig, by_levels
from giraff_base.drives.wheels.drive import WheelsDrive
from giraff_core.kinematics.calibration import Calibration
from giraff_schemas.boards import BaseBoardName
from giraff_schemas.trouble import NO_TROUBLE
from giraff_schemas.wire import PROTOCOL_HASH, ConfigureFrame, Wiring
from tests.support.robot_files import ROBOTS
from tests.support.robots import DRIVE, ROBOT

CONTROL = SpeedControl(max_pwm=120, stall_pwm=41, dead_pwm=6, speed_p=170.4, speed_i=1100.6, turn_p=51.0, turn_i=401.0)
BY_SPEED = msgspec.structs.replace(DRIVE, wheel_control="speed", swap_motors=True, speed_control=CONTROL)


def test_by_levels_nothing_is_told_of_speeds() -> None:
    told = by_levels(Wiring.SWAP_ENCODERS, 70, 25)
    numbers = msgspec.structs.asdict(told)
    assert numbers.pop("protocol_hash") == PROTOCOL_HASH
    assert {name: value for name, value in numbers.items() if value} == {
        "wiring": Wiring.SWAP_ENCODERS,
        "level_max": 70,
        "stall_level": 25,
    }


def test_a_robot_by_levels_is_told_of_its_wheels_so_that_it_measures_their_speeds() -> None:
    told = DRIVE.board_settings(ROBOT, 1.2)
    by_hand = by_levels(DRIVE.wiring, 70, 25)
    assert told == msgspec.structs.replace(by_hand, left_counts_per_km=2_002_059, right_counts_per_km=2_002_059)


def test_a_robot_by_speed_is_told_all_that_it_takes() -> None:
    assert BY_SPEED.board_settings(ROBOT, 1.1875) == ConfigureFrame(
        seq=0,
        protocol_hash=PROTOCOL_HASH,
        boot_id=0,
        board_ms=0,
        session=0,
        wiring=Wiring.SWAP_MOTORS,
        level_max=0,
        stall_level=25,
        left_counts_per_km=2_002_059,
        right_counts_per_km=2_002_059,
        speed_max_um_s=600_000,
        acceleration_um_s2=1_187_500,
        nominal_um_s=600_000,
        nominal_level=70,
        nominal_adc_counts=800,
        motor_ms=150,
        pwm_max=120,
        stall_pwm=41,
        dead_pwm=6,
        speed_p=170,
        speed_i=1101,
        turn_p=51,
        turn_i=401,
    )


def test_a_battery_whose_divider_is_not_known_is_not_told_of() -> None:
    blind = msgspec.structs.replace(BY_SPEED, battery_volts_per_count=0.0)
    assert blind.board_settings(ROBOT, 1.0).nominal_adc_counts == 0


@pytest.mark.parametrize("acceleration", [0.01, 10.0 + 100.0])
@pytest.mark.parametrize("ticks_per_metre", [50.0, 200_000.0])
@pytest.mark.parametrize("max_wheel_speed", [0.02, 5.0])
@pytest.mark.parametrize("control", [CONTROL, SpeedControl(speed_p=3900, speed_i=3900, turn_p=3900, turn_i=3900)])
def test_each_robot_within_the_ranges_fits_into_the_frame(
    acceleration: float, ticks_per_metre: float, max_wheel_speed: float, control: SpeedControl
) -> None:
    robot = msgspec.structs.replace(ROBOT, ticks_per_metre=ticks_per_metre, max_wheel_speed=max_wheel_speed)
    drive = msgspec.structs.replace(BY_SPEED, battery_volts_per_count=24.0 / 1023, speed_control=control)
    told = drive.board_settings(robot, acceleration)
    assert ConfigureFrame.unpack(told.pack()) == told


def refused(**fields: object) -> str:
    """Return why such a drive by speed is refused. By levels it is accepted."""
    values = {**msgspec.to_builtins(BY_SPEED), **fields}
    msgspec.convert({**values, "wheel_control": "level"}, WheelsConfig)
    with pytest.raises(msgspec.ValidationError) as told:
        msgspec.convert(values, WheelsConfig)
    return str(told.value)


def test_what_is_beyond_the_board_is_refused_where_it_is_asked_for_speeds() -> None:
    assert "speed_control.max_pwm is 120 and max_level 121: max_wheel_speed could not be reached" in refused(
        max_level=121
    )
    assert "stall_level is 42 and speed_control.stall_pwm 41: no wheel that stands would ever" in refused(
        stall_level=42
    )
    assert "battery_nominal is 30.75 V, 1025 counts by battery_volts_per_count: the board reads 1023" in refused(
        battery_nominal=30.75
    )
    for fields in ({"max_level": 120}, {"stall_level": 41}, {"battery_nominal": 30.69}):
        msgspec.structs.replace(BY_SPEED, **fields)


@pytest.mark.parametrize(
    ("fields", "told"),
    [
        ({"max_pwm": 39}, "stall_pwm is 40: it must be max_pwm at most, which is 39"),
        ({"stall_pwm": 4}, "dead_pwm is 5: it must be stall_pwm at most, which is 4"),
        ({"dead_pwm": 41}, "dead_pwm is 41: it must be stall_pwm at most, which is 40"),
    ],
)
def test_each_of_the_boards_bounds_is_within_the_next(fields: dict[str, int], told: str) -> None:
    with pytest.raises(ValueError, match=told):
        SpeedControl(**fields)


def test_bounds_may_be_equal() -> None:
    SpeedControl(max_pwm=40, stall_pwm=40, dead_pwm=40)


@pytest.mark.parametrize(
    ("board", "scale", "is_refused"), [("ardros", 1.01, False), ("ardros", 0.98, True), ("base", 0.98, False)]
)
def test_wheels_that_are_faster_than_their_board_counts_are_refused(
    board: BaseBoardName, scale: float, is_refused: bool
) -> None:
    """By what a calibration has made of them: a wheel that is smaller gives more counts."""
    calibration = Calibration(date="2026-11-27", right_wheel_scale=scale)
    fast = msgspec.structs.replace(ROBOT, ticks_per_metre=90_000.0, max_wheel_speed=0.6, calibration=calibration)
    config = msgspec.structs.replace(DRIVE, board=board)
    with pytest.raises(ValueError, match=r"counts 54000; it must be 0\.59 at most") if is_refused else nullcontext():
        WheelsDrive(fast, config, 1.2)


BRIDGE: Final = ROBOTS["ros_arduino_bridge"]


@pytest.mark.parametrize(
    ("fields", "told"),
    [
        ({"wheel_control": "speed"}, "holds speeds by a loop of its own"),
        ({"battery_volts_per_count": 0.1}, "the board ros_arduino_bridge measures no battery; leave it out"),
        (
            {"max_level": 27},
            "within 1/30 s, and max_wheel_speed is 26 of them by ticks_per_metre; it must be 26",
        ),
    ],
)
def test_a_controller_that_holds_speeds_wants_its_own_levels(fields: dict[str, str | float], told: str) -> None:
    with pytest.raises(ValueError, match=told):
        WheelsDrive(BRIDGE.settings.robot, msgspec.structs.replace(BRIDGE.drive, **fields), 1.2)


@pytest.mark.parametrize(
    ("board", "speed", "limit"),
    [
        ("ros_arduino_bridge", 0.6, 0.125),
        ("ros_arduino_bridge", 0.12, math.inf),
        ("roboclaw", 2.0, 1.25),
        ("roboclaw", 0.6, math.inf),
        ("mega_l298n", 2.0, math.inf),
    ],
)
def test_no_robot_drives_on_further_than_a_guards_margin_when_its_controller_hears_nobody(
    board: str, speed: float, limit: float
) -> None:
    """A robot that is as slow as that by its file is not told of it."""
    file = ROBOTS[board]
    robot = msgspec.structs.replace(file.settings.robot, max_wheel_speed=speed)
    level = round(speed * robot.ticks_per_metre / 30.0) if board == "ros_arduino_bridge" else file.drive.max_level
    told = WheelsDrive(robot, msgspec.structs.replace(file.drive, max_level=level), 1.2).limit
    assert told.speed == limit
    assert (told.reason == NO_TROUBLE) == math.isinf(limit)
    if limit == 0.125:
        assert told.reason.what == (
            "the wheels turn at 0.125 m/s at most, because their controller drives on for 2 s when it hears nobody"
        )
