"""What a ping becomes: an echo with its distance, nothing in reach, or a fault with its way out."""

from pathlib import Path
from typing import cast

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from giraff_core.robot import RobotConfig
from giraff_core.senses import Ultrasonic
from giraff_node.config.robot_file import load
from giraff_ranger.config import RangerConfig
from giraff_ranger.policy import LONGEST_ECHO_US, RangerPolicy
from giraff_schemas import frames
from giraff_schemas.boards import NANO_RANGER_BOARD, RANGER_BOARD
from giraff_schemas.bumper import Bump
from giraff_schemas.framing import Decoder, encode
from giraff_schemas.messages import Range, RobotTime, Tick
from giraff_schemas.wire import FrameType, RangeFault, RangeFrame, RangeState, TickFrame
from giraff_schemas.wires.bumper import BumperFrame
from tests.support.robots import BUMPED

ROBOT = msgspec.structs.replace(
    load("robot", RobotConfig, {"GIRAFF_CONFIG": str(Path(__file__).parents[3] / "deploy" / "robot.toml")}),
    sensors={
        "front_left": Ultrasonic(index=0, x=0.25, y=0.15, yaw=0.0),
        "rear": Ultrasonic(index=2, x=-0.25, y=0.0, yaw=3.14),
    },
)


def range_frame(
    sensor: int = 0,
    state: int = RangeState.ECHO,
    *,
    echo_us: int = 5800,
    fault: int = RangeFault.NONE,
    epoch: int = 7,
    seq: int = 0,
) -> RangeFrame:
    return RangeFrame(
        seq=seq,
        board_us=0,
        boot_id=1,
        tick_epoch=epoch,
        tick_robot_ns=42,
        sensor=sensor,
        state=state,
        fault=fault,
        echo_us=echo_us,
        line_errors=0,
    )


def taken(frame: RangeFrame) -> Range:
    sample = RangerPolicy(ROBOT).on_frame(frame)
    assert sample is not None
    return sample


@given(st.integers(1, LONGEST_ECHO_US))
def test_an_echo_is_a_distance_at_58_us_a_centimetre(echo_us: int) -> None:
    sample = taken(range_frame(echo_us=echo_us))
    assert (sample.sensor, sample.state, sample.echo_us, str(sample.reason)) == ("front_left", "echo", echo_us, "")
    assert sample.range == pytest.approx(echo_us / 58 / 100)
    assert sample.tick == RobotTime(epoch=7, robot_ns=42)


def test_a_sensor_goes_by_its_number_on_the_board() -> None:
    assert taken(range_frame(2)).sensor == "rear"


def test_the_scale_of_the_robot_file_is_in_the_range_and_not_in_the_echo() -> None:
    sensors = {name: msgspec.structs.replace(pose, scale=1.03) for name, pose in ROBOT.sensors.items()}
    sample = RangerPolicy(msgspec.structs.replace(ROBOT, sensors=sensors)).on_frame(range_frame(echo_us=5800))
    assert sample is not None
    assert sample.range == pytest.approx(1.03)
    assert sample.echo_us == 5800


@pytest.mark.parametrize("echo_us", [0, 24_000, 38_000, 180_000])
def test_nothing_in_reach_is_clear_and_no_distance(echo_us: int) -> None:
    sample = taken(range_frame(state=RangeState.CLEAR, echo_us=echo_us))
    assert (sample.state, sample.range, sample.echo_us, str(sample.reason)) == ("clear", None, echo_us, "")


@pytest.mark.parametrize(
    ("frame", "told"),
    [
        (range_frame(state=RangeState.FAULT, fault=RangeFault.NO_ECHO_PULSE), ("does not answer", "check its power")),
        (range_frame(state=RangeState.FAULT, fault=RangeFault.STUCK_HIGH), ("holds its echo line high", "check")),
        (range_frame(state=RangeState.FAULT, fault=RangeFault.TOO_SHORT), ("too short", "look for")),
        (range_frame(state=RangeState.FAULT, fault=99), ("fault 99", "reflash")),
        (range_frame(state=RangeState.FAULT, fault=RangeFault.NONE), ("fault 0", "reflash")),
        (range_frame(state=9), ("state 9", "reflash")),
        (range_frame(echo_us=0), ("echo of 0 us", "reflash")),
        (range_frame(echo_us=LONGEST_ECHO_US + 1), ("echo of 38001 us", "reflash")),
    ],
)
def test_a_fault_names_the_sensor_the_cause_and_the_way_out(frame: RangeFrame, told: tuple[str, str]) -> None:
    ranger = RangerPolicy(ROBOT)
    sample = ranger.on_frame(frame)
    assert sample is not None
    assert (sample.state, sample.range) == ("fault", None)
    assert ranger.faults == {"sensor front_left": sample.reason}
    assert str(sample.reason).startswith("front_left ")
    assert (told[0] in str(sample.reason), told[1] in sample.reason.remedy) == (True, True)


def test_a_fault_lasts_until_the_next_sound_reading_of_that_sensor() -> None:
    ranger = RangerPolicy(ROBOT)
    ranger.on_frame(range_frame(0, RangeState.FAULT, fault=RangeFault.STUCK_HIGH))
    ranger.on_frame(range_frame(2))
    assert ranger.faults["sensor front_left"]
    ranger.on_frame(range_frame(0, RangeState.CLEAR))
    assert not any(ranger.faults.values())


def test_a_sensor_that_the_robot_file_does_not_know_is_named() -> None:
    ranger = RangerPolicy(ROBOT)
    assert ranger.on_frame(range_frame(1)) is None
    (message,) = map(str, ranger.faults.values())
    for words in ("sensor 1", "0 = front_left, 2 = rear", "[robot.sensors]"):
        assert words in message


def bumper_frame(is_open: int, epoch: int = 7) -> BumperFrame:
    return BumperFrame(seq=0, board_us=0, boot_id=1, tick_epoch=epoch, tick_robot_ns=42, open=is_open)


def test_each_bumper_goes_by_its_bit_and_has_the_boards_tick() -> None:
    ranger = RangerPolicy(BUMPED)
    tick = RobotTime(epoch=7, robot_ns=42)
    for is_open, pressed in ((0, (False, False)), (1, (True, False)), (2, (False, True)), (0xFF, (True, True))):
        assert ranger.on_bumpers(bumper_frame(is_open), 0.0) == [
            Bump(sensor="front", pressed=pressed[0], tick=tick),
            Bump(sensor="back", pressed=pressed[1], tick=tick),
        ]
    assert {bump.tick for bump in ranger.on_bumpers(bumper_frame(0, epoch=0), 0.0)} == {None}


def test_a_board_is_asked_while_it_tells_nothing_and_an_old_one_is_a_fault() -> None:
    ranger = RangerPolicy(BUMPED)
    assert [eighth for eighth in range(10) if ranger.bumper_request(eighth / 8.0)] == [0, 2, 4, 6, 8]
    assert not any(ranger.faults.values())
    assert ranger.bumper_request(1.25)
    assert str(ranger.faults["bumpers"]) == (
        "the ranger board tells nothing of bumpers; flash it (make -C firmware flash BOARD=ranger)"
    )
    ranger.on_bumpers(bumper_frame(0), 1.26)
    assert not any(ranger.faults.values())
    assert ranger.bumper_request(1.45) is None
    assert ranger.bumper_request(1.47) is not None
    assert not any(ranger.faults.values())


def test_a_robot_without_bumpers_asks_for_none() -> None:
    assert RangerPolicy(ROBOT).bumper_request(9.0) is None


def test_a_ping_made_before_the_robot_was_heard_has_no_tick() -> None:
    assert taken(range_frame(epoch=0)).tick is None


def test_frames_across_the_wrap_of_their_sequence_all_count() -> None:
    ranger = RangerPolicy(ROBOT)
    assert all(ranger.on_frame(range_frame(seq=seq)) for seq in (65534, 65535, 0, 1))


def test_ticks_go_down_as_they_are_and_their_sequence_wraps() -> None:
    ranger = RangerPolicy(ROBOT)
    ticks = (ranger.on_tick(Tick(epoch=7, robot_ns=ns), 0.0) for ns in range(0x10001))
    frames = [frame for frame in ticks if frame is not None]
    assert [frame.seq for frame in (frames[0], frames[-3], frames[-2], frames[-1])] == [1, 65535, 0, 1]
    assert Decoder().feed(encode(frames[5].pack())) == [TickFrame(seq=6, epoch=7, robot_ns=5)]


@given(st.binary(min_size=RangeFrame.layout.size - 1, max_size=RangeFrame.layout.size - 1))
def test_whatever_the_board_sends_a_range_is_finite_and_within_reach(payload: bytes) -> None:
    (frame,) = Decoder().feed(encode(bytes((FrameType.RANGE,)) + payload))
    ranger = RangerPolicy(ROBOT)
    sample = ranger.on_frame(cast(RangeFrame, frame))
    if sample is None:
        assert any(ranger.faults.values())
        return
    assert (sample.state == "fault") == bool(sample.reason)
    assert sample.range is None or 0.0 < sample.range < 7.0


def test_the_configuration_wants_a_port() -> None:
    assert msgspec.convert({}, RangerConfig) == RangerConfig()
    with pytest.raises(msgspec.ValidationError, match="port is empty"):
        msgspec.convert({"port": ""}, RangerConfig)
    with pytest.raises(msgspec.ValidationError, match="unknown field `sensors`"):
        msgspec.convert({"sensors": {}}, RangerConfig)


def test_a_nano_is_a_ranger_of_the_robot_file() -> None:
    config = msgspec.convert({"board": "nano_ranger"}, RangerConfig)
    assert (RangerConfig().board_type, config.board_type) == (RANGER_BOARD, NANO_RANGER_BOARD)
    ranger = RangerPolicy(BUMPED, config.board_type)
    assert all(ranger.bumper_request(float(second)) for second in range(6))
    assert ranger.faults["bumpers"].remedy == "flash it (make -C firmware flash BOARD=nano_ranger)"
    with pytest.raises(msgspec.ValidationError, match="Invalid enum value 'base'"):
        msgspec.convert({"board": "base"}, RangerConfig)


def test_a_sensors_frame_is_where_it_sits() -> None:
    where = {
        each.child: (each.parent, each.x, each.y, each.yaw, each.fixed) for each in RangerPolicy(ROBOT).transforms()
    }
    assert where == {
        frames.range_frame("front_left"): (frames.BASE_FRAME, 0.25, 0.15, 0.0, True),
        frames.range_frame("rear"): (frames.BASE_FRAME, -0.25, 0.0, 3.14, True),
    }
